#include "apps/report/sections/sensitivity_tables.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/numbers.hpp"

namespace calomel {

const Json& sensitivity_summary(const Study& study) {
  static const Json nothing;
  return study.sensitivity ? study.sensitivity->summary : nothing;
}

const std::vector<std::string>& run_total_names() {
  static const std::vector<std::string> names{"dissipated_energy", "time_at_cutoff"};
  return names;
}

bool is_run_total(const std::string& quantity) { return std::find(run_total_names().begin(), run_total_names().end(), quantity) != run_total_names().end(); }

std::string record_label(const Json& quantity) {
  const std::string sensor = text_at(quantity, "sensor");
  const std::string condition = text_at(quantity, "condition");
  if (sensor.empty() && is_run_total(text_at(quantity, "name"))) return condition.empty() ? "the run" : condition;
  if (sensor.empty()) return "all records";
  return condition.empty() ? sensor : sensor + ", " + condition;
}

std::string plain_quantity(const std::string& name) {
  static const std::map<std::string, std::string> plain{{"peak", "greatest absolute value"},
                                                        {"time_of_peak", "time of the greatest value"},
                                                        {"rms", "root mean square"},
                                                        {"dissipated_energy", "dissipated energy"},
                                                        {"time_at_cutoff", "time at the cutoff"}};
  const auto found = plain.find(name);
  return found == plain.end() ? name : found->second;
}

DisplayUnit effect_unit(const Json& quantity, const DisplayUnit& of_records, const DisplayUnit& of_times) {
  const std::string unit = text_at(quantity, "unit");
  return unit == "s" ? of_times : is_run_total(text_at(quantity, "name")) ? DisplayUnit{unit, 1} : of_records;
}

std::vector<std::string> names_of(const Json& indices) {
  std::vector<std::string> names;
  for (const auto& i : indices) names.push_back(text_at(i, "parameter"));
  return names;
}

namespace {

/// "0.38 (0.34 to 0.42)"
std::string with_interval(const Json& index) {
  constexpr int decimals = 2;
  const auto value = number_at(index, "value");
  const auto low = number_at(index, "low");
  const auto high = number_at(index, "high");
  if (!value) return "\u2013";
  const std::string s = fixed_text(*value, decimals);
  return low && high ? s + " (" + fixed_text(*low, decimals) + " to " + fixed_text(*high, decimals) + ")" : s;
}

}  // namespace

Table sensitivity_table(const Study& study) {
  Table t{.id = "sensitivity", .caption = "First-order and total indices of every record with 95 % intervals, over the whole record."};
  t.columns = {{"record", "Record", 4, true}, {"parameter", "Parameter", 4, true},    {"first_order", "Alone", -3}, {"first_low", "from", -3},
               {"first_high", "to", -3},      {"total_order", "With the others", -3}, {"total_low", "from", -3},    {"total_high", "to", -3}};
  const Json& quantities = list_at(sensitivity_summary(study), "quantities");
  const auto add = [&](const Json& q) {
    const Json& first = list_at(q, "first_order");
    const Json& total = list_at(q, "total_order");
    for (std::size_t k = 0; k < first.size() && k < total.size(); ++k)
      t.rows.push_back({record_label(q), text_at(first[k], "parameter"), number_at(first[k], "value"), number_at(first[k], "low"), number_at(first[k], "high"),
                        number_at(total[k], "value"), number_at(total[k], "low"), number_at(total[k], "high")});
  };
  for (const bool all : {true, false})
    for (const auto& q : quantities)
      if ((text_at(q, "name") == "record" || text_at(q, "name") == "value") && text_at(q, "sensor").empty() == all) add(q);
  return t;
}

Table total_order_table(const Study& study, const std::string& quantity) {
  const bool record = quantity == "record";
  Table t{.id = "sensitivity_" + quantity,
          .caption = (record ? std::string("Total index of each parameter over the whole record")
                             : "Total index of each parameter for the " + plain_quantity(quantity)) +
                     ", with 95 % intervals; bold: the greatest of the row."};
  t.columns = {{"record", "Record", 4, true}};
  for (const auto& name : names_of(list_at(sensitivity_summary(study), "total_order"))) t.columns.push_back({name, name, 4, true});
  for (const auto& q : list_at(sensitivity_summary(study), "quantities")) {
    if (text_at(q, "name") != quantity) continue;
    const Json& total = list_at(q, "total_order");
    double greatest = -1;
    for (const auto& i : total) greatest = std::max(greatest, number_at(i, "value").value_or(-1));
    std::vector<Cell> row{record_label(q)};
    for (const auto& i : total) row.emplace_back(with_interval(i), number_at(i, "value") == std::optional(greatest));
    t.rows.push_back(std::move(row));
  }
  return t;
}

Table morris_table(const Study& study, const ReportInput& input) {
  Table t{.id = "sensitivity_morris", .caption = "Elementary effects: the change of a number as a parameter goes through its whole range."};
  t.columns = {{"quantity", "Number", 4, true},
               {"record", "Record", 4, true},
               {"unit", "Unit", 4, true},
               {"parameter", "Parameter", 4, true},
               {"mu", "Mean", 3},
               {"mu_star", "Mean of the absolute values", 3},
               {"mu_star_se", "its standard error", 2},
               {"sigma", "Standard deviation", 3}};
  const auto unit = display_unit(input);
  for (const auto& q : list_at(sensitivity_summary(study), "quantities")) {
    const auto effects = effect_unit(q, unit, study.time);
    for (const auto& e : list_at(q, "morris")) {
      std::vector<Cell> row{plain_quantity(text_at(q, "name")), record_label(q), effects.name, text_at(e, "parameter")};
      for (const char* key : {"mu", "mu_star", "mu_star_se", "sigma"}) {
        const auto x = number_at(e, key);
        row.emplace_back(x ? std::optional(effects.factor * *x) : std::nullopt);
      }
      t.rows.push_back(std::move(row));
    }
  }
  return t;
}

}  // namespace calomel
