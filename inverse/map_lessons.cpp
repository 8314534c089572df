#include "inverse/map_lessons.hpp"

#include "inverse/mesh_pairs.hpp"
#include "inverse/refined_model.hpp"

namespace calomel {

namespace {

/// Runs that came through, as columns.
struct Learnt {
  Eigen::MatrixXd theta, working, pair_theta, difference;
};

/// Of the runs at which the search's own surrogate has values too.
Learnt learnt_from(const std::vector<AddedRun>& runs, std::size_t parameters, const ForwardModel& surrogate) {
  std::vector<const AddedRun*> done, paired;
  for (const auto& r : runs) {
    if (!surrogate.evaluate(r.theta).ok) continue;
    if (r.working.done) done.push_back(&r);
    if (r.paired()) paired.push_back(&r);
  }
  const Eigen::Index rows = done.empty() ? 0 : Eigen::Index(done[0]->working.mean.size());
  Learnt l{Eigen::MatrixXd(parameters, done.size()), Eigen::MatrixXd(rows, done.size()), Eigen::MatrixXd(parameters, paired.size()),
           Eigen::MatrixXd(rows, paired.size())};
  for (std::size_t i = 0; i < done.size(); ++i) {
    l.theta.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(done[i]->theta.data(), Eigen::Index(parameters));
    l.working.col(Eigen::Index(i)) = values_of(done[i]->working.mean);
  }
  for (std::size_t i = 0; i < paired.size(); ++i) {
    l.pair_theta.col(Eigen::Index(i)) = Eigen::Map<const Eigen::VectorXd>(paired[i]->theta.data(), Eigen::Index(parameters));
    l.difference.col(Eigen::Index(i)) = values_of(paired[i]->fine->mean) - values_of(paired[i]->working.mean);
  }
  return l;
}

}  // namespace

void teach(MapModels& current, const MapModels& models, const std::vector<AddedRun>& runs, const MapSearch& search) {
  const SearchSpace& space = search.space();
  const Learnt learnt = learnt_from(runs, std::size_t(space.size()), *models.surrogate);
  if (learnt.theta.cols() >= 2) {
    current.refined = std::make_shared<RefinedModel>(*models.surrogate, models.surrogate_variance, learnt.theta, learnt.working);
    current.surrogate = current.refined.get();
    current.surrogate_variance = [refined = current.refined](std::span<const double> theta) { return refined->error_variance(theta); };
  }
  if (learnt.pair_theta.cols() >= 2)
    current.mesh = MeshError(space.parameters(), learnt.pair_theta, learnt.difference, {.mean = search.options().mesh_beyond, .sd = search.options().mesh_beyond_sd});
}

}  // namespace calomel
