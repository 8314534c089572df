#include "apps/exit_status.hpp"

#include <filesystem>
#include <fstream>
#include <new>

namespace calomel {

namespace {

/// The line that an error speaks of, and a caret below its column; nothing when it cannot be shown.
std::string shown_line(const InputError::Parts& at) {
  if (at.line <= 0 || at.file.empty()) return "";
  std::ifstream in(at.file);
  std::string line;
  for (int i = 0; i < at.line; ++i)
    if (!std::getline(in, line)) return "";
  if (line.size() > 160 || line.empty()) return "";
  std::string shown = "  " + line + '\n';
  if (at.column > 0 && std::size_t(at.column) <= line.size()) {
    shown += "  ";
    for (int i = 1; i < at.column; ++i) shown += line[std::size_t(i - 1)] == '\t' ? '\t' : ' ';
    shown += "^\n";
  }
  return shown;
}

int failed(std::ostream& err, ExitStatus status, const std::string& what) {
  err << what << '\n';
  return int(status);
}

}  // namespace

int guarded(const std::function<ExitStatus()>& body, std::ostream& err) {
  try {
    return int(body());
  } catch (const InputError& e) {
    failed(err, ExitStatus::bad_input, (e.parts().file.empty() ? "calomel: " : "") + std::string(e.what()));
    err << shown_line(e.parts());
    return int(ExitStatus::bad_input);
  } catch (const NumericsError& e) {
    return failed(err, ExitStatus::failed_numerics, std::string("calomel: the computation failed: ") + e.what());
  } catch (const Interrupted& e) {
    return failed(err, ExitStatus::interrupted, std::string("calomel: ") + e.what());
  } catch (const std::filesystem::filesystem_error& e) {
    return failed(err, ExitStatus::bad_input, e.path1().string() + ": " + e.code().message() + "; check the path and the rights");
  } catch (const std::bad_alloc&) {
    return failed(err, ExitStatus::failed_numerics, "calomel: the machine has not enough memory; take a larger geometry.element_size or fewer --threads");
  } catch (const std::exception& e) {
    err << "calomel: a defect of the program, please report it: " << e.what() << '\n';
    return 1;
  }
}

}  // namespace calomel
