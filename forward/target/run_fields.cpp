#include "forward/target/run_fields.hpp"

namespace calomel {

RunFields::RunFields(std::filesystem::path path, const Mesh& mesh, double interval, SolveOptions& options) : path_(std::move(path)), mesh_(mesh) {
  options.field_interval = interval;
  options.on_field = [this, balanced = options.energy_balance](const FieldSnapshot& s) {
    if (!writer_) writer_.emplace(path_, mesh_);
    writer_->write_step({s.time, s.displacement, s.velocity, s.pressure, s.effective_stress, balanced ? s.time_at_cutoff : std::span<const double>{}});
  };
  options.checkpoint.before_saving = [this](std::int64_t) {
    if (writer_) writer_->flush();
  };
  options.checkpoint.on_resume = [this](std::int64_t, std::int64_t fields, bool finished) {
    if (finished && committed()) return;  // by the call that finished this condition
    writer_.emplace(path_, mesh_, int(fields));
  };
}

void RunFields::commit() {
  if (writer_) writer_->commit(), writer_.reset();
}

void RunFields::leave() {
  if (writer_) writer_->leave();
}

bool RunFields::committed() const { return std::filesystem::exists(path_) && !std::filesystem::exists(path_.string() + ".part"); }

}  // namespace calomel
