// Tests the record of the verification and the table made from it.
#include "tests/verification/table.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include "base/artefact.hpp"
#include "base/errors.hpp"

using namespace calomel;
using namespace calomel::testing;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

namespace {

Row example(const std::string& quantity, double value) {
  return {.item = "Taylor plate",
          .quantity = quantity,
          .unit = "m/s",
          .reference = 2,
          .source = "a, b and \"c\"",
          .measured = value,
          .tolerance = 0.1,
          .order = 1.9,
          .control = "spoiled",
          .control_value = 3};
}

/// A committed table of two rows.
struct Committed {
  std::filesystem::path page = std::filesystem::temp_directory_path() / ("calomel_table_" + std::to_string(::getpid()) + ".md");
  explicit Committed(const Record& record) { write_atomically(page, table_page(record)); }
  ~Committed() { std::filesystem::remove(page); }
};

const Record two{.rows = {example("one", 2.01), example("two", 1.95)}, .curves = {}, .absent = {}};

}  // namespace

TEST(Table, ARowSurvivesItsFile) {
  const Row row = row_from_line(to_line(example("one, with a comma", 2.0123)));
  EXPECT_EQ(row.quantity, "one, with a comma");
  EXPECT_EQ(row.source, "a, b and 'c'");
  EXPECT_DOUBLE_EQ(row.measured, 2.0123);
  EXPECT_THROW((void)row_from_line("1,2,3"), InputError);
}

TEST(Table, ComparesEqualWithItself) { EXPECT_THAT(compare(two, Committed(two).page), IsEmpty()); }

TEST(Table, AValueMayMoveByATenthOfItsToleranceOnly) {
  const Committed committed(two);
  Record moved = two;
  moved.rows[0].measured += 0.009;
  EXPECT_THAT(compare(moved, committed.page), IsEmpty());
  moved.rows[0].measured += 0.002;
  EXPECT_THAT(compare(moved, committed.page), ElementsAre(HasSubstr("moved: Taylor plate | one")));
}

TEST(Table, AdditionalAndMissingRowsAreReported) {
  const Committed committed(two);
  Record other = two;
  other.rows[1].quantity = "three";
  EXPECT_THAT(compare(other, committed.page),
              ElementsAre(HasSubstr("not in the table: Taylor plate | three"), HasSubstr("but not recorded: Taylor plate | two")));
  other = two;
  other.rows.push_back(two.rows[0]);
  EXPECT_THAT(compare(other, committed.page), ElementsAre(HasSubstr("recorded twice")));
  // The rows of a test that could not run may be missing.
  other = two;
  other.rows.pop_back();
  other.absent = {"BoxSlice.X: no reference solutions"};
  EXPECT_THAT(compare(other, committed.page), IsEmpty());
}

TEST(Table, AnItemWithoutARowIsRefused) { EXPECT_THROW(write_pages(two, std::filesystem::temp_directory_path() / "calomel_never_written"), InputError); }
