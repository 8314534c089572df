#include "inverse/enc/enc.hpp"

#include "base/provenance.hpp"

namespace calomel {

Json enc_json(const EncSummary& s, const Problem& problem, const EncWords& words, const Provenance& provenance) {
  const auto& shape = problem.shape;
  Json own;
  own["optimizers"] = Json::array();
  own["rounds"] = Json::array();
  for (const auto& o : s.optimizers)
    own["optimizers"].push_back(
        {{"name", o.name}, {"rounds", o.rounds}, {"mean", number(o.mean)}, {"sd", number(o.sd)}, {"best", number(o.best)}, {"trace", numbers(o.trace)}});
  for (const auto& r : s.rounds)
    own["rounds"].push_back(
        {{"optimizer", r.optimizer}, {"theta", named(shape.parameters, r.theta)}, {"objective", number(r.objective)}, {"evaluations", r.evaluations}});
  own["agreement"] = agreement_json(s.agreement, problem, words.agreement);
  own["agreement_s"] = s.agreement_s;
  return calibration_json(s, problem, own, words.calibration, provenance);
}

void write_enc(const EncSummary& s, const Problem& problem, const EncWords& words, const Provenance& provenance, const std::filesystem::path& out_dir) {
  write_calibration("enc", s, problem, enc_json(s, problem, words, provenance), provenance, out_dir);
}

}  // namespace calomel
