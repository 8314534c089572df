#include "apps/report/report.hpp"

#include <fmt/format.h>

#include <map>

#include "apps/report/chains.hpp"
#include "apps/report/comparison_tables.hpp"
#include "apps/report/diagnosis_tables.hpp"
#include "apps/report/emulator_tables.hpp"
#include "apps/report/embedded.hpp"
#include "apps/report/floor_tables.hpp"
#include "apps/report/page.hpp"
#include "apps/report/posterior.hpp"
#include "apps/report/sensitivity.hpp"
#include "apps/report/spe_tables.hpp"
#include "apps/report/study.hpp"
#include "apps/report/tables.hpp"
#include "apps/report/traces.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"

namespace calomel {

namespace {
constexpr std::size_t most_bytes = 9'500'000;  // of the page: its contract is 10 MB

/// A script as it may stand inside <script>: nothing in it may end the element or open an HTML comment.
std::string inside_script(std::string_view text) {
  std::string s(text);
  for (const auto& [from, to] : {std::pair{"</script", "<\\/script"}, std::pair{"<!--", "<\\!--"}})
    for (auto at = s.find(from); at != std::string::npos; at = s.find(from, at + 1)) s.replace(at, std::string_view(from).size(), to);
  return s;
}

/// JSON inside <script type="application/json">: "<" only as an escape.
std::string inside_script(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string s;
  s.reserve(text.size());
  for (const char c : text) s += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return s;
}

/// The template with every {{name}} replaced; what is put in is not searched again.
std::string filled(std::string_view text, const std::map<std::string, std::string>& parts) {
  std::string s;
  for (std::size_t at = 0;;) {
    const auto open = text.find("{{", at);
    s += text.substr(at, open - at);
    if (open == std::string_view::npos) return s;
    const auto close = text.find("}}", open);
    const auto found = parts.find(std::string(text.substr(open + 2, close - open - 2)));
    expect(close != std::string_view::npos && found != parts.end(), "the page template names only parts that are made");
    s += found->second;
    at = close + 2;
  }
}
}  // namespace

void expect_something_to_report(const std::filesystem::path& out_dir, const std::string& case_file) {
  if (!read_study(out_dir).empty()) return;
  throw InputError({.problem = std::filesystem::exists(out_dir) ? "holds no artefact of any stage, so there is nothing to report"
                                                                : "is not there, so there is nothing to report",
                    .suggestion = "run calomel study " + (case_file.empty() ? "CASE.toml" : case_file) +
                                  " first, or a stage of it (simulate, campaign, train, calibrate, sample, sensitivity, diagnose), with the same --out",
                    .file = out_dir.string()});
}

void write_report(const std::filesystem::path& out_dir, const ReportInput& input) {
  expect_something_to_report(out_dir, input.case_file);
  const Study study = read_study(out_dir, input.time_end);
  std::map<std::string, std::string> parts{
      {"title", escape_html(input.case_name)},
      {"header", header_html(study, input)},
      {"first_link", study.diagnosis ? "<li><a href=\"#diagnosis\">Left out</a></li>\n" : ""},
      {"sections", sections_html(study, input)},
      {"style", std::string(embedded::dygraphs_css) + std::string(embedded::page_css)},
      {"libraries", inside_script(embedded::dygraphs_js) + "\n" + inside_script(embedded::synchronizer_js) + "\n" + inside_script(embedded::three_js) + "\n" +
                        inside_script(embedded::orbit_controls_js)},
      {"scripts", inside_script(embedded::drawing_js) + "\n" + inside_script(embedded::histories_js) + "\n" + inside_script(embedded::target_js) + "\n" +
                      inside_script(embedded::diagnosis_js) + "\n" + inside_script(embedded::corner_js) + "\n" + inside_script(embedded::chains_js) + "\n" +
                      inside_script(embedded::sensitivity_js) + "\n" + inside_script(embedded::page_js)},
      {"version", escape_html(version)}};
  std::size_t samples = 3000, quads = 24000, points = 2000;
  for (int attempt = 0; attempt < 12; ++attempt) {
    parts["data"] = inside_script(page_data(study, input, samples, quads, points));
    const std::string page = filled(embedded::page_html, parts);
    if (page.size() <= most_bytes) {
      write_atomically(out_dir / "report.html", page);
      return;
    }
    samples = samples * 2 / 3, quads = quads * 2 / 3, points = points * 2 / 3;
  }
  throw InputError({.problem = "the page would be larger than 10 MB even with few samples a trace",
                    .suggestion = "report fewer sensors, or read the artefacts with report --csv",
                    .file = (out_dir / "report.html").string()});
}

std::vector<std::filesystem::path> write_tables_csv(const std::filesystem::path& out_dir, const ReportInput& input) {
  expect_something_to_report(out_dir, input.case_file);
  const Study study = read_study(out_dir, input.time_end);
  const auto folder = out_dir / "report_csv";
  make_directory(folder);
  std::vector<std::filesystem::path> paths;
  const auto write = [&](const std::string& name, const std::string& text) {
    const auto path = folder / (name + ".csv");
    if (text.empty()) {  // a stage that is gone leaves no table of an earlier report behind
      std::filesystem::remove(path);
      return;
    }
    write_atomically(path, text);
    paths.push_back(path);
  };
  for (const Table& t : {headline_table(study, input),
                         parameter_table(study, input),
                         sensor_table(input),
                         score_table(study, input, "accuracy"),
                         score_table(study, input, "mae"),
                         mesh_table(study, input),
                         agreement_table(study),
                         place_table(study),
                         effort_table(study),
                         nuisance_table(study),
                         pull_table(study),
                         emulator_table(study),
                         share_table(study),
                         hypothesis_table(study),
                         optimizer_agreement_table(study),
                         formulation_table(study, input),
                         trial_table(study),
                         decay_table(study),
                         optimizer_table(study),
                         convergence_table(study),
                         round_table(study, input),
                         candidate_table(study, input),
                         surrogate_table(study, input),
                         polynomial_error_table(study),
                         polynomial_table(study),
                         lambda_table(study),
                         mode_table(study, input),
                         loss_table(study),
                         design_table(study),
                         failure_table(study, std::size_t(-1)),
                         scatter_table(study, input),
                         floor_table(study),
                         floor_sensor_table(study),
                         posterior_table(study, input),
                         prior_table(study, input),
                         floor_window_table(study, input),
                         mismatch_table(study),
                         mismatch_map_table(study),
                         band_table(study),
                         explanation_table(study),
                         reason_table(study),
                         missing_table(study),
                         effect_table(study),
                         handbook_table(study, input),
                         sensitivity_table(study),
                         morris_table(study, input)})
    write(t.id, t.empty() ? "" : t.csv());
  write("histories", histories_csv(study, input));
  write("diagnosis_histories", diagnosis_histories_csv(study, input));
  write("posterior_predictive", predictive_histories_csv(study, input));
  write("posterior_draws", posterior_draws_csv(study));
  return paths;
}

}  // namespace calomel
