#pragma once
/// The case file of an external model, `[model] kind = "umbridge"`.
#include <string>
#include <vector>

#include "base/case_file.hpp"
#include "forward/external/umbridge_client.hpp"
#include "forward/parameter_group.hpp"

namespace calomel {

/// `[model]` with kind = "umbridge".
struct ServerOptions {
  std::string kind = "umbridge", url, name;
  double timeout = 300;
  int retries = 4;
  double pause = 0.1;
  template <class V>
  void visit(V& v) {
    v("kind", kind, {.doc = "umbridge: a model behind HTTP, UM-Bridge 1.0", .choices = {"umbridge"}});
    v("url", url, {.doc = "of its server, http://HOST:PORT", .required = true});
    v("name", name, {.doc = "of the model, one of those that the server lists", .required = true});
    v("timeout", timeout, {.unit = "s", .range = {.low = 0, .high = 1e6, .low_open = true}, .doc = "for one response, first to last byte"});
    v("retries", retries, {.range = between(0, 20), .doc = "of a request that was not answered"});
    v("pause", pause, {.unit = "s", .range = between(0, 60), .doc = "before the first retry; each further one waits twice as long, up to half a minute"});
  }
};

/// `[output] time` of an external model.
struct OutputTime {
  double start = 0, step = 0;
  int count = 0;
  template <class V>
  void visit(V& v) {
    v("start", start, {.unit = "s", .doc = "of the first value"});
    v("step", step, {.unit = "s", .range = above(0), .doc = "between values", .required = true});
    v("count", count, {.range = between(1, 10000000), .doc = "values of one sensor", .required = true});
  }
};

/// `[output]`: what the model's first output block is.
struct OutputOptions {
  std::string kind = "records";
  std::vector<std::string> sensors;
  template <class V>
  void visit(V& v) {
    v("kind", kind, {.doc = "records: histories, sensor by sensor; log_density: one number, for samplers only", .choices = {"records", "log_density"}});
    v("sensors", sensors, {.doc = "names of the recorded quantities, in the order of the block"});
  }
};

/// `[mechanism.NAME]` of an external model: inputs that are at their `off` values in the base model.
struct ExternalMechanism {
  std::string name;
  bool enabled = false;
  std::vector<Parameter> parameters;  ///< as the file has them; their key is "mechanism.NAME.parameter.P"
  std::vector<double> off;
};

struct ExternalCase {
  std::string name;
  std::string unit;  ///< of the values
  UmbridgeOptions server;
  OutputOptions output;
  OutputTime time;
  std::vector<Parameter> parameters;          ///< what is uncertain: `[parameter.*]` and those of the mechanisms that are enabled; nominal filled
  std::size_t own = 0;                        ///< how many of these are `[parameter.*]`
  std::vector<ExternalMechanism> mechanisms;  ///< file order

  /// Reads every table of such a case. Errors: InputError with the place.
  static ExternalCase read(CaseFile& file);

  [[nodiscard]] bool is_log_density() const { return output.kind == "log_density"; }
  /// Number of inputs: the parameters, then those of every mechanism.
  [[nodiscard]] std::size_t inputs() const;
  /// Resolved options by table.
  [[nodiscard]] Json echo() const;
  /// Of these what a run depends on, for provenance: not where the server is, nor priors, nor which mechanisms are enabled. Of parameters the bounds, which
  /// designs depend on.
  [[nodiscard]] Json model_options() const;
};

/// Keys of a gauge that does not read true, which are no inputs of the model: each followed by ".SENSOR". A reading is taken times gain + drift (t - t_first) /
/// (t_last - t_first).
inline const std::string reading_gain = "sensor_response.gain", reading_drift = "sensor_response.drift";

/// The mechanisms that are not enabled, as groups of numbers that may be added; and, where there are several sensors, the response of each, unless the case has
/// a mechanism of the name "sensor_response" itself.
[[nodiscard]] std::vector<ParameterGroup> offered_groups(const ExternalCase& external);

}  // namespace calomel
