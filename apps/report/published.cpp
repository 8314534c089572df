#include "apps/report/published.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "apps/report/table.hpp"
#include "apps/report/tables.hpp"
#include "base/json.hpp"

namespace calomel {

namespace {

struct Published {
  const char* method;
  double density, sound_speed, tensile_cutoff;  ///< [kg/m3], [m/s], [Pa]
};
constexpr std::array<Published, 2> answers{{{"ENC", 10345, 2020, 85642}, {"SPE", 7720, 2449, 53300}}};

constexpr double mercury = 13546, near = 0.05;  ///< [kg/m3] at 20 degrees; relative distance that temperature and gas may make

/// The case's names of the three parameters, by their keys.
std::map<std::string, std::string> names_by_key(const ReportInput& input) {
  std::map<std::string, std::string> names;
  for (const auto& p : input.parameters) names[p.key.empty() ? "material.mercury." + p.name : p.key] = p.name;
  return names;
}

std::string with_sign(double x) { return (x > 0 ? "+" : "") + fixed_html(x, std::abs(x) < 9.95 ? 1 : 0); }

}  // namespace

std::vector<PublishedAnswer> published_answers(const ReportInput& input) {
  const auto names = names_by_key(input);
  const std::array<std::string, 3> keys{"material.mercury.density", "material.mercury.sound_speed", "material.mercury.tensile_cutoff"};
  if (names.size() != keys.size() || std::any_of(keys.begin(), keys.end(), [&](const auto& k) { return !names.contains(k); })) return {};
  const auto own = impedance(input).density_value;
  if (!own || std::abs(*own / mercury - 1) > near) return {};
  std::vector<PublishedAnswer> out;
  for (const auto& a : answers)
    out.push_back(
        {std::string(a.method) + ", published", {{names.at(keys[0]), a.density}, {names.at(keys[1]), a.sound_speed}, {names.at(keys[2]), a.tensile_cutoff}}});
  return out;
}

std::string published_paragraph(const Study& study, const ReportInput& input) {
  const auto list = published_answers(input);
  if (list.empty() || !study.posterior) return "";
  const Draws& draws = *study.posterior;
  const Impedance z = impedance(input);
  std::map<std::string, std::pair<double, double>> known;  // mean and sd
  double product = 0;
  const double n = double(draws.chains * draws.draws);
  std::map<std::string, std::vector<double>> values;
  for (std::size_t k = 0; k < draws.names.size(); ++k) {
    auto x = draws.of(k);
    double mean = 0, square = 0;
    for (const double v : x) mean += v / n;
    for (const double v : x) square += (v - mean) * (v - mean) / n;
    known[draws.names[k]] = {mean, std::sqrt(square)}, values[draws.names[k]] = std::move(x);
  }
  if (!known.contains(z.density) || !known.contains(z.sound_speed)) return "";
  for (std::size_t i = 0; i < values[z.density].size(); ++i) product += values[z.density][i] * values[z.sound_speed][i] / n;
  std::string s =
      "<p>Published for mercury are (M. I. Radaideh, H. Tran, L. Lin, H. Jiang, D. Winder, S. Gorti, G. Zhang, J. Mach, S. Cousineau, \u201cModel Calibration "
      "of the Liquid Mercury Spallation Target using Evolutionary Neural Networks and Sparse "
      "Polynomial Expansions\u201d, 2022, arXiv:2202.09353):</p>\n<ul>\n";
  for (std::size_t a = 0; a < list.size(); ++a) {
    const Json& theta = list[a].theta;
    std::string where;
    for (const auto& p : input.parameters) {
      const auto at = known.find(p.name);
      const auto value = number_at(theta, p.name);
      if (at == known.end() || !value || !(at->second.second > 0)) continue;
      where += (where.empty() ? "" : ", ") + escape_html(p.name) + " " + with_sign((*value - at->second.first) / at->second.second);
    }
    s += "<li>" + list[a].label.substr(0, list[a].label.find(',')) + " " + number_html(*number_at(theta, z.density), 5) + "\u00a0kg/m\u00b3, " +
         number_html(*number_at(theta, z.sound_speed), 4) + "\u00a0m/s, " +
         number_html(*number_at(theta, names_by_key(input).at("material.mercury.tensile_cutoff")), 5) +
         "\u00a0Pa: \u03c1c = " + fixed_html(*z.at(theta) * 1e-6, 1) +
         "\u00a0MPa\u00b7s/m; from the mean of this posterior, in its standard deviations: " + where + "</li>\n";
  }
  return s + "</ul>\n<p>Here \u03c1c is " + fixed_html(product * 1e-6, 1) +
         "\u00a0MPa\u00b7s/m. They fit that paper\u2019s records and target, so they need not lie here. Mercury\u2019s density is near "
         "13\u202f500\u00a0kg/m\u00b3: the authors find their values far from the "
         "nominal properties, and give the form of the model and errors of the measurements as reasons. Density and sound speed trade against each other along "
         "\u03c1c = const, the dashed line of the corner plot.</p>\n";
}

}  // namespace calomel
