#include "apps/pipeline/histories_file.hpp"

#include "base/json.hpp"
#include "base/netcdf_file.hpp"
#include "base/provenance.hpp"

namespace calomel {

void write_histories(const std::filesystem::path& path, const ModelShape& shape, const std::vector<double>& strain, const Provenance& provenance) {
  NetcdfWriter file(path);
  file.attribute("title", "calomel simulation");
  file.attribute("unit", shape.unit);
  file.attribute("provenance", provenance.json().dump());
  std::vector<std::string> dims{"sensor", "time"};
  if (shape.conditions.size() > 1) {
    file.dimension("condition", shape.conditions.size());
    file.variable("condition", {"condition"}, shape.conditions);
    dims.insert(dims.begin(), "condition");
  }
  file.dimension("sensor", shape.sensors.size());
  file.dimension("time", shape.times.size());
  file.variable("sensor", {"sensor"}, shape.sensors);
  file.variable("time", {"time"}, shape.times, {{"units", "s"}});
  file.variable("strain", dims, strain, {{"units", shape.unit == "strain" ? "1" : shape.unit}});
  file.commit();
}

}  // namespace calomel
