// verification_table ROWS FOLDER: writes FOLDER/table.md and the pictures from what the verification tests left in ROWS.
// verification_table --check ROWS FOLDER: compares the committed table with them. Exit status 1 and a line for each difference; 77, by which ctest reports the
// test as skipped, where nothing differs but some tests could not run.
#include <iostream>

#include "base/errors.hpp"
#include "tests/verification/table.hpp"

int main(int argc, char** argv) {
  using namespace calomel::testing;
  const std::vector<std::string> words(argv + 1, argv + argc);
  const bool check = !words.empty() && words[0] == "--check";
  if (words.size() != (check ? 3 : 2)) {
    std::cerr << "verification_table [--check] ROWS FOLDER\n";
    return 2;
  }
  try {
    const Record record = read_record(words[words.size() - 2]);
    const std::filesystem::path folder = words.back();
    for (const auto& a : record.absent) std::cout << "not compared: " << a << '\n';
    if (!check) {
      write_pages(record, folder);
      return 0;
    }
    const auto differences = compare(record, folder / "table.md");
    for (const auto& d : differences) std::cout << d << '\n';
    if (!differences.empty()) return 1;
    return record.absent.empty() ? 0 : 77;
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
}
