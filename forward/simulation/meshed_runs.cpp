#include "forward/simulation/meshed_runs.hpp"

#include <algorithm>
#include <cmath>

namespace calomel {

namespace {

constexpr double rounding = 1e-5;  ///< of the histories: a smaller change is lost in single precision

/// The level on which effects are measured: the next to finest.
int effect_level(const MeshedRuns& runs) { return std::min(1, runs.levels() - 1); }

}  // namespace

RunRequest MeshedRuns::request(std::span<const double> theta, int level) const {
  RunRequest request = request_at(parameters_, theta);
  const RunRequest& mesh = meshes_[std::size_t(level)];
  request.element_size = mesh.element_size;
  request.numbers.insert(mesh.numbers.begin(), mesh.numbers.end());
  return request;
}

std::vector<RunRecord> MeshedRuns::get(const Eigen::MatrixXd& thetas, const std::vector<int>& level, std::span<const AddedParameter> added,
                                       const Runs::Progress& progress) const {
  const auto own = parameters_.size();
  expect(std::size_t(thetas.rows()) == own + added.size(), "a theta holds the parameters and what is added");
  std::vector<RunRequest> requests;
  for (std::size_t i = 0; i < level.size(); ++i) {
    const auto theta = thetas.col(Eigen::Index(i));
    requests.push_back(request({theta.data(), own}, level[i]));
    set_added(requests.back().numbers, {theta.data() + own, added.size()}, added);
  }
  return runs_->get(requests, progress);
}

std::vector<RunRequest> meshes_of(const std::vector<double>& element_sizes, const std::map<std::string, double>& numbers) {
  if (element_sizes.empty()) return {RunRequest{}};
  std::vector<RunRequest> meshes;
  for (auto size = element_sizes.rbegin(); size != element_sizes.rend(); ++size) {
    RunRequest mesh;
    mesh.numbers = numbers;
    mesh.element_size = *size;
    meshes.push_back(std::move(mesh));
  }
  return meshes;
}

Eigen::MatrixXd gauge_place_effects(const MeshedRuns& runs, std::span<const double> theta, double sd, double element_size, const Runs::Progress& progress) {
  const Simulator& simulator = runs.runs().simulator();
  const double shift = std::max(sd, 0.5 * element_size);
  const ModelShape& shape = simulator.shape();
  const RunRequest base = runs.request(theta, effect_level(runs));
  const auto sensors = shape.sensors.size();
  const auto times = Eigen::Index(shape.times.size());
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(Eigen::Index(shape.values()), Eigen::Index(sensors));
  const auto put = [&](std::size_t s, const RunRecord& up, const RunRecord& down, double apart) {
    for (std::size_t c = 0; c < shape.conditions.size(); ++c) {
      const auto at = Eigen::Index(shape.at(c, s, 0));
      directions.col(Eigen::Index(s)).segment(at, times) = sd / apart * (up.history() - down.history()).segment(at, times);
    }
  };
  std::vector<RunRequest> requests(2, base);
  for (std::size_t s = 0; s < sensors; ++s) {
    (void)simulator.move_gauge(requests[0], s, shift);
    (void)simulator.move_gauge(requests[1], s, -shift);
  }
  const auto all = runs.runs().get(requests, progress);
  if (all[0].done && all[1].done) {
    for (std::size_t s = 0; s < sensors; ++s) put(s, all[0], all[1], 2 * shift);
    return directions;
  }
  // A gauge near an edge cannot be moved beyond it. Each gauge is then moved by itself, to one side where the other fails.
  requests.assign(1, base);
  for (std::size_t s = 0; s < sensors; ++s)
    for (const double by : {shift, -shift}) {
      requests.push_back(base);
      (void)simulator.move_gauge(requests.back(), s, by);
    }
  const auto each = runs.runs().get(requests, progress);
  for (std::size_t s = 0; s < sensors; ++s) {
    const RunRecord &up = each[1 + 2 * s], &down = each[2 + 2 * s];
    if (up.done && down.done)
      put(s, up, down, 2 * shift);
    else if (up.done && each[0].done)
      put(s, up, each[0], shift);
    else if (down.done && each[0].done)
      put(s, each[0], down, shift);
  }
  return directions;
}

std::vector<MechanismDirections> mechanism_directions(const MeshedRuns& runs, std::span<const double> theta, const Runs::Progress& progress) {
  const RunRequest base = runs.request(theta, effect_level(runs));
  const auto keys = runs.runs().simulator().score_test_keys(base);
  /// The two runs of a key; the first is the base model's where it starts at its off value.
  struct Pair {
    std::size_t from = 0, to = 0;
  };
  std::vector<Pair> pairs;
  std::vector<RunRequest> requests{base};
  for (const auto& k : keys) {
    const auto with = [&](double value) {
      requests.push_back(base);
      requests.back().numbers["mechanism." + k.mechanism + '.' + k.key] = value;
      return requests.size() - 1;
    };
    Pair pair;
    if (k.low != k.off) pair.from = with(k.low);
    pair.to = with(k.high);
    pairs.push_back(pair);
  }
  const auto records = runs.runs().get(requests, progress);
  std::vector<MechanismDirections> out;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const KeyDifference& k = keys[i];
    const RunRecord &from = records[pairs[i].from], &to = records[pairs[i].to];
    if (!from.done || !to.done) continue;
    const Eigen::VectorXd change = to.history() - from.history();
    if (!(change.norm() > rounding * from.history().norm())) continue;  // its effect cannot show here
    if (out.empty() || out.back().name != k.mechanism)
      out.push_back({.name = k.mechanism, .keys = {}, .off = {}, .directions = {}, .like_the_mesh = k.like_the_mesh});
    MechanismDirections& m = out.back();
    // An infinite value switches such a key off. Its inverse is counted in its place.
    const bool finite = std::isfinite(k.off);
    m.keys.push_back(finite ? k.key : "1/" + k.key);
    m.off.push_back(finite ? k.off : 0);
    m.directions.conservativeResize(change.size(), Eigen::Index(m.keys.size()));
    m.directions.rightCols(1) = change / (finite ? k.high - k.low : 1 / k.high - (std::isfinite(k.low) ? 1 / k.low : 0));
  }
  return out;
}

}  // namespace calomel
