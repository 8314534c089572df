#include "apps/report/report.hpp"

#include <map>
#include <string_view>
#include <utility>

#include "apps/report/data/study.hpp"
#include "apps/report/embedded.hpp"
#include "apps/report/page.hpp"
#include "apps/report/parts/elements.hpp"
#include "apps/report/parts/traces.hpp"
#include "apps/report/sections/campaign.hpp"
#include "apps/report/sections/candidates.hpp"
#include "apps/report/sections/chains.hpp"
#include "apps/report/sections/comparison.hpp"
#include "apps/report/sections/convergence.hpp"
#include "apps/report/sections/diagnosis_tables.hpp"
#include "apps/report/sections/emulator.hpp"
#include "apps/report/sections/floor.hpp"
#include "apps/report/sections/header.hpp"
#include "apps/report/sections/parameters.hpp"
#include "apps/report/sections/polynomials.hpp"
#include "apps/report/sections/posterior.hpp"
#include "apps/report/sections/scores.hpp"
#include "apps/report/sections/sensitivity_tables.hpp"
#include "apps/report/sections/surrogate.hpp"
#include "apps/report/sections/target.hpp"
#include "base/artefact.hpp"

namespace calomel {

namespace {

constexpr std::size_t most_bytes = 9'500'000;  ///< greatest size of the page, whose contract is 10 MB

/// A script for the inside of <script>: nothing in it may end the element or open an HTML comment.
std::string inside_script(std::string_view text) {
  std::string s(text);
  for (const auto& [from, to] : {std::pair{"</script", "<\\/script"}, std::pair{"<!--", "<\\!--"}})
    for (auto at = s.find(from); at != std::string::npos; at = s.find(from, at + 1)) s.replace(at, std::string_view(from).size(), to);
  return s;
}

/// JSON for the inside of <script type="application/json">: "<" only as an escape.
std::string inside_script(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string s;
  s.reserve(text.size());
  for (const char c : text) s += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return s;
}

/// Scripts one after another.
Html scripts(const std::vector<std::string_view>& texts) {
  std::string all;
  for (const auto& text : texts) {
    if (!all.empty()) all += "\n";
    all += inside_script(text);
  }
  return trusted_html(std::move(all));
}

/// The template with every {{name}} replaced by its part. The parts are not searched again.
std::string filled(std::string_view text, const std::map<std::string, Html>& parts) {
  std::string s;
  for (std::size_t at = 0;;) {
    const auto open = text.find("{{", at);
    s += text.substr(at, open - at);
    if (open == std::string_view::npos) return s;
    const auto close = text.find("}}", open);
    const auto found = parts.find(std::string(text.substr(open + 2, close - open - 2)));
    expect(close != std::string_view::npos && found != parts.end(), "the page template names only parts that are made");
    s += found->second.str();
    at = close + 2;
  }
}

/// All parts of the template but the data of the drawings.
std::map<std::string, Html> page_parts(const Study& study, const ReportInput& input) {
  using namespace embedded;
  return {{"title", input.case_name},
          {"header", header_html(study, input)},
          {"first_link", study.diagnosis ? list_item(link_to("diagnosis", "Left out")) : Html()},
          {"sections", sections_html(study, input)},
          {"style", trusted_html(std::string(dygraphs_css) + std::string(page_css))},
          {"libraries", scripts({dygraphs_js, synchronizer_js, three_js, orbit_controls_js})},
          {"scripts", scripts({drawing_js, histories_js, target_js, diagnosis_js, corner_js, chains_js, sensitivity_js, page_js})},
          {"version", version}};
}

/// Every table of the report; a table may be empty.
std::vector<Table> all_tables(const Study& study, const ReportInput& input) {
  return {headline_table(study, input),
          parameter_table(study, input),
          sensor_table(input),
          score_table(study, input, "accuracy"),
          score_table(study, input, "mae"),
          mesh_table(study, input),
          agreement_table(study),
          place_table(study),
          effort_table(study),
          nuisance_table(study),
          prior_deviation_table(study),
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
          morris_table(study, input)};
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
  std::map<std::string, Html> parts = page_parts(study, input);
  DrawingLimits limits;
  for (int attempt = 0; attempt < 12; ++attempt) {
    parts["data"] = trusted_html(inside_script(page_data(study, input, limits)));
    const std::string page = filled(embedded::page_html, parts);
    if (page.size() <= most_bytes) {
      write_atomically(out_dir / "report.html", page);
      return;
    }
    limits = {limits.samples * 2 / 3, limits.quads * 2 / 3, limits.points * 2 / 3};
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
    if (text.empty()) {  // a table of an earlier report does not remain when its stage is gone
      std::filesystem::remove(path);
      return;
    }
    write_atomically(path, text);
    paths.push_back(path);
  };
  for (const Table& t : all_tables(study, input)) write(t.id, t.empty() ? "" : t.csv());
  write("histories", histories_csv(study, input));
  write("diagnosis_histories", diagnosis_histories_csv(study, input));
  write("posterior_predictive", predictive_histories_csv(study, input));
  write("posterior_draws", posterior_draws_csv(study));
  return paths;
}

}  // namespace calomel
