#include "apps/report/sections/surrogate.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>

#include "apps/report/data/json_values.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/parts/lines.hpp"
#include "apps/report/sections/polynomials.hpp"

namespace calomel {

Table surrogate_table(const Study& study, const ReportInput& input) {
  const auto unit = display_unit(input);
  Table t{.id = "surrogates", .caption = "Surrogates of the simulation, scored on runs that they were not trained on."};
  t.columns = {{"surrogate", "Surrogate", 4, true},
               {"kind", "Kind", 4, true},
               {"n_train", "Training runs", 6},
               {"n_test", "Test runs", 6},
               {"mae", "Mean absolute error [" + unit.name + "]", 4},
               {"rmse", "Root mean square error [" + unit.name + "]", 4},
               {"r2", "R\u00b2", 5}};
  const auto shown = [&](const std::optional<double>& x) { return x ? std::optional(unit.factor * *x) : std::nullopt; };
  if (study.train)
    for (const auto& s : list_at(*study.train, "surrogates"))
      t.rows.push_back({text_at(s, "name"), text_at(s, "kind"), number_at(s, "n_train"), number_at(s, "n_test"), shown(number_at(s, "mae")),
                        shown(number_at(s, "rmse")), number_at(s, "r2")});
  if (!t.rows.empty()) t.note = "R\u00b2 is pooled over all outputs: 1 \u2212 \u03a3 error\u00b2 / \u03a3 (value \u2212 mean over runs)\u00b2.";
  return t;
}

Table loss_table(const Study& study) {
  Table t{.id = "training_loss", .caption = "Training loss by epoch."};
  t.columns = {{"surrogate", "Surrogate", 4, true}, {"epoch", "Epoch", 6}, {"train_loss", "Training loss", 5}, {"test_loss", "Test loss", 5}};
  if (study.train)
    for (const auto& s : list_at(*study.train, "surrogates")) {
      const Json& train = list_at(s, "train_loss");
      const Json& test = list_at(s, "test_loss");
      for (std::size_t i = 0; i < std::max(train.size(), test.size()); ++i) {
        const auto at = [&](const Json& list) { return i < list.size() && list[i].is_number() ? Cell(list[i].get<double>()) : Cell(); };
        t.rows.push_back({text_at(s, "name"), double(i + 1), at(train), at(test)});
      }
    }
  return t;
}

Html surrogate_section(const Study& study, const ReportInput& input) {
  const Html polynomials = polynomials_part(study, input);
  if (!study.train) return polynomials + missing("No surrogate has been trained (train.json).", fragment("Train one with ", command(input, "train"), "."));
  const Table table = surrogate_table(study, input);
  Html s = table.empty() ? missing("train.json lists no surrogates.") : table.html();
  if (!loss_table(study).empty())
    s +=
        plot("loss-plot",
             "Training and test loss by epoch, logarithmic. Losses of different networks are of different quantities: compare their shapes, not their heights.",
             "Training loss");
  return s + polynomials;
}

Json loss_json(const Study& study) {
  const Table t = loss_table(study);
  if (t.empty()) return nullptr;
  return {{"lines", lines_json(t, {2, 3})}, {"x_label", "epoch"}, {"y_label", "loss"}};
}

}  // namespace calomel
