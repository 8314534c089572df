#include "forward/surrogate/surrogate.hpp"

#include <functional>
#include <limits>

#include "base/json.hpp"
#include "forward/surrogate/stored_array.hpp"

namespace calomel {
namespace {

const char* const format = "calomel surrogate 1";

/// Sets Options from the JSON that `echo` wrote.
class JsonReader {
 public:
  explicit JsonReader(const Json& json) : json_(json) {}
  template <class T>
  void operator()(const char* key, T& value, const FieldInfo&) {
    if (!json_.contains(key)) return;
    if constexpr (std::is_same_v<T, std::optional<double>>)
      value = json_.at(key).get<double>();
    else
      value = json_.at(key).get<T>();
  }

 private:
  const Json& json_;
};

Json shape_json(const ModelShape& shape) {
  Json parameters = Json::array();
  for (const auto& p : shape.parameters) {
    Json row = echo(p);
    row["name"] = p.name;
    parameters.push_back(std::move(row));
  }
  return {{"parameters", parameters}, {"conditions", shape.conditions}, {"sensors", shape.sensors}, {"unit", shape.unit}};
}

}  // namespace

Surrogate::Surrogate(Parts parts) : parts_(std::move(parts)) {
  expect(parts_.mean != nullptr, "a surrogate has an emulator of the mean");
  expect(std::size_t(parts_.held_out.size()) == parts_.shape.values(), "the held-out error has one number a value");
}

bool Surrogate::inside(const double* theta, std::string* why) const {
  for (std::size_t j = 0; j < parts_.shape.parameters.size(); ++j) {
    const Parameter& p = parts_.shape.parameters[j];
    const double slack = 1e-9 * (p.max - p.min);
    if (theta[j] >= p.min - slack && theta[j] <= p.max + slack) continue;
    if (why) *why = "surrogate: " + p.name + " = " + number_text(theta[j]) + " lies outside the campaign's bounds " + Range{p.min, p.max}.text();
    return false;
  }
  return true;
}

Prediction Surrogate::evaluate(std::span<const double> theta) const {
  expect(theta.size() == parts_.shape.parameters.size(), "a point has as many numbers as the surrogate has parameters");
  Prediction p;
  p.ok = inside(theta.data(), &p.message);
  if (!p.ok) return p;
  const Eigen::MatrixXd at = Eigen::Map<const Eigen::VectorXd>(theta.data(), Eigen::Index(theta.size()));
  const auto values = [&](const TrainedMap& map) {
    const Eigen::MatrixXf y = map.histories(at, 1);
    return std::vector<double>(y.data(), y.data() + y.size());
  };
  p.mean = values(*parts_.mean);
  if (parts_.slope) p.energy_slope = values(*parts_.slope);
  if (parts_.scatter) {
    p.scatter = values(*parts_.scatter);
    for (double& s : p.scatter) s = std::max(s, 0.0);  // a standard deviation
  }
  return p;
}

Eigen::MatrixXf Surrogate::at_inside(const Eigen::MatrixXd& thetas, const std::function<Eigen::MatrixXf(const Eigen::MatrixXd&)>& of) const {
  expect(std::size_t(thetas.rows()) == parts_.shape.parameters.size(), "a point has as many numbers as the surrogate has parameters");
  std::vector<Eigen::Index> good;
  for (Eigen::Index i = 0; i < thetas.cols(); ++i)
    if (inside(thetas.col(i).data(), nullptr)) good.push_back(i);
  if (std::ssize(good) == thetas.cols()) return of(thetas);
  const Eigen::MatrixXf kept = of(thetas(Eigen::all, good));
  Eigen::MatrixXf y = Eigen::MatrixXf::Constant(kept.rows(), thetas.cols(), std::numeric_limits<float>::quiet_NaN());
  y(Eigen::all, good) = kept;
  return y;
}

Eigen::MatrixXf Surrogate::means(const Eigen::MatrixXd& thetas, int threads) const {
  return at_inside(thetas, [&](const Eigen::MatrixXd& x) { return parts_.mean->histories(x, threads); });
}

Eigen::MatrixXf Surrogate::coefficients(const Eigen::MatrixXd& thetas) const {
  return at_inside(thetas, [&](const Eigen::MatrixXd& x) { return parts_.mean->coefficients(x); });
}

Eigen::VectorXd Surrogate::vector_jacobian_product(std::span<const double> theta, std::span<const double> weights) const {
  expect(weights.size() == parts_.shape.values(), "a weight for each value of the surrogate");
  return parts_.mean->vector_jacobian_product(Eigen::Map<const Eigen::VectorXd>(theta.data(), Eigen::Index(theta.size())),
                                              Eigen::Map<const Eigen::VectorXd>(weights.data(), Eigen::Index(weights.size())));
}

Eigen::VectorXd Surrogate::error_variance(std::span<const double> theta) const {
  const Eigen::VectorXd own = parts_.mean->variance(Eigen::Map<const Eigen::VectorXd>(theta.data(), Eigen::Index(theta.size())));
  return own.size() > 0 ? Eigen::VectorXd(parts_.variance_factor * own) : Eigen::VectorXd(parts_.held_out.cast<double>());
}

void Surrogate::save(const std::filesystem::path& path) const {
  NetcdfWriter file(path);
  file.attribute("format", format);
  file.attribute("kind", parts_.kind);
  file.attribute("shape", shape_json(parts_.shape).dump());
  file.dimension("time", parts_.shape.times.size());
  file.variable("time", {"time"}, std::span<const double>(parts_.shape.times), {{"units", "s"}});
  store(file, "held_out_error", Eigen::MatrixXf(parts_.held_out), {{"long_name", "mean squared error over the held-out runs"}});
  store(file, "variance_factor", Eigen::MatrixXd(Eigen::MatrixXd::Constant(1, 1, parts_.variance_factor)));
  parts_.mean->save(file, "mean_");
  file.attribute("has_energy_slope", parts_.slope ? "yes" : "no");
  file.attribute("has_scatter", parts_.scatter ? "yes" : "no");
  if (parts_.slope) parts_.slope->save(file, "energy_slope_");
  if (parts_.scatter) parts_.scatter->save(file, "scatter_");
  file.commit();
}

std::unique_ptr<Surrogate> load_surrogate(const std::filesystem::path& path) {
  const NetcdfReader file(path);
  if (file.attribute("format") != format)
    throw InputError({.problem = "is no surrogate that this program wrote", .value = path.string(), .suggestion = "run `calomel train` again"});
  Surrogate::Parts parts;
  parts.kind = file.attribute("kind");
  const Json shape = Json::parse(file.attribute("shape"));
  for (const auto& row : shape.at("parameters")) {
    Parameter p;
    JsonReader reader(row);
    p.visit(reader);
    p.name = row.at("name").get<std::string>();
    parts.shape.parameters.push_back(std::move(p));
  }
  parts.shape.conditions = shape.at("conditions").get<std::vector<std::string>>();
  parts.shape.sensors = shape.at("sensors").get<std::vector<std::string>>();
  parts.shape.unit = shape.at("unit").get<std::string>();
  parts.shape.times = file.doubles("time");
  parts.held_out = stored_matrix<float>(file, "held_out_error").col(0);
  parts.variance_factor = file.doubles("variance_factor")[0];
  const auto kinds = surrogate_kinds();
  parts.mean = kinds.get(parts.kind).load(file, "mean_");
  const auto& companion = kinds.get("mode_gaussian_process");
  if (file.attribute("has_energy_slope") == "yes") parts.slope = companion.load(file, "energy_slope_");
  if (file.attribute("has_scatter") == "yes") parts.scatter = companion.load(file, "scatter_");
  return std::make_unique<Surrogate>(std::move(parts));
}

}  // namespace calomel
