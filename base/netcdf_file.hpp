#pragma once
/// netCDF-4 files: every array artefact, with named dimensions, coordinates and units (xarray and ncdump read them).
/// HDF5 is not thread-safe: one writer or reader at a time, which a lock in the implementation ensures.
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace calomel {

/// Text attributes of a variable, e.g. {{"units", "s"}, {"long_name", "time"}}.
using Attributes = std::map<std::string, std::string>;

/// Writes to `path` + ".part"; `commit()` syncs and renames, so a reader never sees half a file.
/// Errors: InputError when the file cannot be made or the disk is full.
class NetcdfWriter {
 public:
  explicit NetcdfWriter(std::filesystem::path path);
  ~NetcdfWriter();
  NetcdfWriter(const NetcdfWriter&) = delete;
  NetcdfWriter& operator=(const NetcdfWriter&) = delete;

  /// Later declarations and values go into this group, which is made when it is new; "" is the root. A group has dimensions of its own
  /// beside those of the root.
  void group(const std::string& name);
  /// Of the file, or of the group that is being written.
  void attribute(const std::string& name, const std::string& text);
  void dimension(const std::string& name, std::size_t size);
  /// values: row-major over `dims`; an empty `dims` is a scalar. NaN is stored as NaN with `_FillValue` NaN.
  void variable(const std::string& name, const std::vector<std::string>& dims, std::span<const double> values, const Attributes& attributes = {});
  void variable(const std::string& name, const std::vector<std::string>& dims, std::span<const float> values, const Attributes& attributes = {});
  void variable(const std::string& name, const std::vector<std::string>& dims, std::span<const int> values, const Attributes& attributes = {});
  void variable(const std::string& name, const std::vector<std::string>& dims, std::span<const std::int8_t> values, const Attributes& attributes = {});
  void variable(const std::string& name, const std::vector<std::string>& dims, std::span<const std::string> values, const Attributes& attributes = {});
  /// A CF status variable: `flag_values` 0, 1, ... with their meanings.
  void flags(const std::string& name, const std::vector<std::string>& dims, std::span<const int> values, std::span<const std::string> meanings);
  void commit();

 private:
  int define(const std::string& name, const std::vector<std::string>& dims, int type, std::size_t given, const Attributes& attributes);
  std::filesystem::path path_, part_;
  int id_ = -1;
  int at_ = -1;                                                                   ///< the group that is being written; id_ at the root
  std::map<int, std::map<std::string, std::pair<int, std::size_t>>> dimensions_;  ///< of each group: id and size
};

/// A variable of a group is called "group/variable". Errors: InputError when the file is absent, no netCDF, or lacks the variable.
class NetcdfReader {
 public:
  explicit NetcdfReader(std::filesystem::path path);
  ~NetcdfReader();
  NetcdfReader(const NetcdfReader&) = delete;
  NetcdfReader& operator=(const NetcdfReader&) = delete;

  [[nodiscard]] bool has(const std::string& variable) const;
  /// Names of the groups below the root, in the order of the file.
  [[nodiscard]] std::vector<std::string> groups() const;
  /// Names of the variables of a group, without the group's name, in the order of the file; "" is the root.
  [[nodiscard]] std::vector<std::string> variables(const std::string& group = "") const;
  [[nodiscard]] std::vector<std::size_t> shape(const std::string& variable) const;
  [[nodiscard]] std::vector<std::string> dimensions(const std::string& variable) const;
  [[nodiscard]] std::vector<double> doubles(const std::string& variable) const;
  [[nodiscard]] std::vector<int> integers(const std::string& variable) const;
  [[nodiscard]] std::vector<std::string> strings(const std::string& variable) const;
  /// Whether a variable holds text.
  [[nodiscard]] bool holds_text(const std::string& variable) const;
  /// Global attribute, or empty; with `variable`, the attribute of that variable; with "group/", that of the group.
  [[nodiscard]] std::string attribute(const std::string& name, const std::string& variable = "") const;

 private:
  struct Place {
    int group, variable;
  };
  [[nodiscard]] int group_id(const std::string& group) const;
  [[nodiscard]] Place place(const std::string& variable) const;
  std::filesystem::path path_;
  int id_ = -1;
};

}  // namespace calomel
