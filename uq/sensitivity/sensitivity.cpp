#include "uq/sensitivity/sensitivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/errors.hpp"
#include "base/json.hpp"
#include "base/not_finite.hpp"
#include "uq/sensitivity/totals.hpp"

namespace calomel {

namespace {

constexpr Eigen::Index block_rows = 64;  ///< rows of the design that are evaluated together
constexpr double most_failed = 0.2;      ///< greatest share of failed evaluations of a result to be trusted
constexpr int morris_levels = 8;

/// The number of numbers of one record; the record itself is a further quantity.
constexpr std::size_t numbers_a_record = 3;

/// The numbers of each record, (records x numbers_a_record, n), or the values themselves where a record has one value.
Eigen::MatrixXd numbers_of(const ModelShape& shape, const Eigen::MatrixXd& f) {
  const auto times = Eigen::Index(shape.times.size()), records = f.rows() / times;
  if (times == 1) return f;
  Eigen::MatrixXd out(records * Eigen::Index(numbers_a_record), f.cols());
  for (Eigen::Index i = 0; i < f.cols(); ++i)
    for (Eigen::Index r = 0; r < records; ++r) {
      const auto y = f.col(i).segment(r * times, times);
      Eigen::Index at = 0;
      const double peak = y.allFinite() ? y.cwiseAbs().maxCoeff(&at) : nan;
      const Eigen::Index row = r * Eigen::Index(numbers_a_record);
      out(row, i) = peak;
      out(row + 1, i) = std::isfinite(peak) ? shape.times[std::size_t(at)] : nan;
      out(row + 2, i) = std::sqrt(y.squaredNorm() / double(times));
    }
  return out;
}

/// Names, sensors and units of the rows of numbers_of, without results.
std::vector<QuantitySensitivity> described(const ModelShape& shape) {
  std::vector<QuantitySensitivity> out;
  const bool many = shape.conditions.size() > 1;
  for (const auto& c : shape.conditions)
    for (const auto& s : shape.sensors) {
      const auto add = [&](const char* name, const std::string& unit) {
        QuantitySensitivity q;
        q.name = name;
        q.sensor = s;
        q.condition = many ? c : "";
        q.unit = unit;
        out.push_back(std::move(q));
      };
      if (shape.times.size() == 1) {
        add("value", shape.unit);
        continue;
      }
      add("peak", shape.unit);
      add("time_of_peak", "s");
      add("rms", shape.unit);
    }
  return out;
}

/// The rows of every number and of every record, gathered block by block.
class Rows {
 public:
  Rows(const ModelShape& shape, Eigen::Index parameters, Eigen::Index most)
      : shape_(shape),
        d_(parameters),
        times_(Eigen::Index(shape.times.size())),
        records_(Eigen::Index(shape.values()) / times_),
        numbers_(times_ == 1 ? records_ : records_ * Eigen::Index(numbers_a_record)),
        curves(Eigen::Index(shape.values()), parameters),
        at_a(numbers_, most),
        unit_a(parameters, most) {
    const Eigen::Index quantities = numbers_ + (times_ == 1 ? 0 : records_) + 1;
    for (Eigen::Index q = 0; q < quantities; ++q) all_.push_back({Eigen::VectorXd(most), Eigen::MatrixXd(most, d_), Eigen::MatrixXd(most, d_)});
  }
  /// Adds one row, f: (values, d + 2), whose A is at `unit`. Returns false where a value is missing.
  bool add(const Eigen::MatrixXd& f, const Eigen::VectorXd& unit) {
    if (!f.allFinite()) return false;
    curves.add(f);
    const Eigen::MatrixXd numbers = numbers_of(shape_, f);
    at_a.col(n) = numbers.col(0);
    unit_a.col(n) = unit;
    const auto half = [](const auto& a, const auto& b) { return 0.5 * (a - b).squaredNorm(); };
    const auto put = [&](SobolRows& rows, const auto& part) {
      rows.variance[n] = half(part(0), part(1));
      for (Eigen::Index k = 0; k < d_; ++k) {
        rows.alone(n, k) = half(part(1), part(2 + k));
        rows.total(n, k) = half(part(0), part(2 + k));
      }
    };
    std::size_t q = 0;
    for (Eigen::Index i = 0; i < numbers_; ++i) put(all_[q++], [&](Eigen::Index c) { return Eigen::VectorXd::Constant(1, numbers(i, c)); });
    for (Eigen::Index r = 0; r < records_ && times_ > 1; ++r)
      put(all_[q++], [&](Eigen::Index c) { return Eigen::VectorXd(f.col(c).segment(r * times_, times_)); });
    put(all_[q], [&](Eigen::Index c) { return Eigen::VectorXd(f.col(c)); });
    ++n;
    return true;
  }
  [[nodiscard]] SobolIndices indices(std::size_t q, std::uint64_t seed) const {
    return sobol_indices({all_[q].variance.head(n), all_[q].alone.topRows(n), all_[q].total.topRows(n)}, seed);
  }
  [[nodiscard]] Eigen::Index numbers() const { return numbers_; }
  [[nodiscard]] Eigen::Index records() const { return times_ == 1 ? 0 : records_; }

 private:
  const ModelShape& shape_;
  Eigen::Index d_, times_, records_, numbers_;
  std::vector<SobolRows> all_;

 public:
  SobolCurves curves;
  Eigen::MatrixXd at_a;    ///< (numbers, rows) at the points A
  Eigen::MatrixXd unit_a;  ///< (d, rows) the points A in the unit cube
  Eigen::Index n = 0;      ///< number of complete rows
};

}  // namespace

Json identity_options(const SensitivityOptions& options) {
  Json json = echo(options);
  if (!options.run_totals) json.erase("run_totals");
  return json;
}

Sensitivity analyse_sensitivity(const SensitivityInputs& in) {
  const ModelShape& shape = in.model.shape();
  const auto d = Eigen::Index(shape.parameters.size());
  const auto rows_wanted = Eigen::Index(in.options.samples);
  const Eigen::MatrixXd design = sobol_rows_design(std::size_t(d), std::size_t(rows_wanted), in.seed);
  const Eigen::MatrixXd steps = morris_design(std::size_t(d), std::size_t(in.options.trajectories), morris_levels, in.seed);
  const auto all = std::size_t(design.cols() + steps.cols());
  Sensitivity out;
  const auto evaluate = [&](const Eigen::MatrixXd& unit) {
    if (in.stop && *in.stop) throw Interrupted();
    Eigen::MatrixXd f = in.model.means(in.theta(unit), in.threads).cast<double>();
    out.evaluations += std::size_t(unit.cols());
    for (Eigen::Index i = 0; i < f.cols(); ++i) out.failed += !f.col(i).allFinite();
    if (in.progress) in.progress(out.evaluations, all);
    return f;
  };

  Rows rows(shape, d, rows_wanted);
  for (Eigen::Index begin = 0; begin < rows_wanted; begin += block_rows) {
    const Eigen::Index count = std::min(block_rows, rows_wanted - begin);
    const auto unit = design.middleCols(begin * (d + 2), count * (d + 2));
    const Eigen::MatrixXd f = evaluate(unit);
    for (Eigen::Index i = 0; i < count; ++i) (void)rows.add(f.middleCols(i * (d + 2), d + 2), unit.col(i * (d + 2)));
  }
  Eigen::MatrixXd at_steps(rows.numbers(), steps.cols());
  for (Eigen::Index begin = 0; begin < steps.cols(); begin += block_rows) {
    const Eigen::Index count = std::min(block_rows, steps.cols() - begin);
    at_steps.middleCols(begin, count) = numbers_of(shape, evaluate(steps.middleCols(begin, count)));
  }
  out.rows = std::size_t(rows.n);
  out.design_rows = std::size_t(rows_wanted);
  if (rows.n == 0)
    throw NumericsError(
        fmt::format("{} of {} evaluations of the model failed, so that no row of the design has all its values: narrow the bounds of the parameters to where "
                    "the model has answers",
                    out.failed, out.evaluations));
  out.many_failed = double(out.failed) > most_failed * double(out.evaluations);
  const auto effects = morris_effects(steps, at_steps);

  // The polynomial is fitted to runs of the model itself where there are any.
  Eigen::MatrixXd x = rows.unit_a.leftCols(rows.n);
  Eigen::MatrixXd numbers = rows.at_a.leftCols(rows.n);
  if (in.runs) {
    const Eigen::MatrixXd unit = unit_of(in.runs->thetas, shape.parameters);
    const Eigen::MatrixXd values = numbers_of(shape, in.runs->means);
    std::vector<Eigen::Index> whole;
    for (Eigen::Index i = 0; i < values.cols(); ++i)
      if (values.col(i).allFinite()) whole.push_back(i);
    x = unit(Eigen::all, whole);
    numbers = values(Eigen::all, whole);
  }
  const bool polynomial = in.options.measure == "uniform" && x.cols() >= 3 * (d + 1);

  out.quantities = described(shape);
  for (std::size_t q = 0; q < out.quantities.size(); ++q) {
    auto& one = out.quantities[q];
    const auto row = rows.at_a.row(Eigen::Index(q)).head(rows.n);
    one.mean = row.maxCoeff() > row.minCoeff() ? row.mean() : row[0];
    one.sd = std::sqrt((row.array() - one.mean).square().mean());
    one.sobol = rows.indices(q, in.seed);
    one.morris = effects[q];
    if (!polynomial) continue;
    if (auto chaos = fit_chaos(2 * x.array() - 1, numbers.row(Eigen::Index(q)).transpose()); chaos.coefficients.size() > 0) one.chaos = std::move(chaos);
  }
  std::size_t q = out.quantities.size();
  if (in.totals)
    for (auto& one : analyse_totals(in, design, steps)) out.quantities.push_back(std::move(one));
  const auto record = [&](const std::string& condition, const std::string& sensor) {
    QuantitySensitivity one;
    one.name = "record";
    one.sensor = sensor;
    one.condition = condition;
    one.unit = shape.unit;
    one.mean = nan;
    one.sobol = rows.indices(q++, in.seed);
    one.sd = std::sqrt(one.sobol.variance);
    out.quantities.push_back(std::move(one));
  };
  if (rows.records() > 0)
    for (const auto& c : shape.conditions)
      for (const auto& s : shape.sensors) record(shape.conditions.size() > 1 ? c : "", s);
  record("", "");
  for (auto& one : out.quantities)
    if (one.finding == ShareFinding::reliable && !(one.sobol.variance > 0)) one.finding = ShareFinding::constant;
  out.first_order = rows.curves.first_order();
  out.total_order = rows.curves.total_order();
  out.sd = (rows.curves.variance() / std::max<double>(1, double(rows.n))).cwiseSqrt();
  return out;
}

}  // namespace calomel
