#include "base/netcdf_file.hpp"

#include <fcntl.h>
#include <netcdf.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <mutex>
#include <utility>

#include "base/artefact.hpp"
#include "base/errors.hpp"

namespace calomel {

namespace {

std::recursive_mutex& hdf5_lock() {
  static std::recursive_mutex lock;
  return lock;
}

void check(int status, const std::filesystem::path& path, const std::string& doing) {
  if (status != NC_NOERR)
    throw InputError({.problem = doing + ": " + nc_strerror(status), .suggestion = "check the path, the free space and the format", .file = path.string()});
}

void put_attributes(int id, int variable, const Attributes& attributes, const std::filesystem::path& path) {
  for (const auto& [name, text] : attributes) check(nc_put_att_text(id, variable, name.c_str(), text.size(), text.c_str()), path, "attribute " + name);
}

}  // namespace

NetcdfWriter::NetcdfWriter(std::filesystem::path path) : path_(std::move(path)), part_(path_.string() + ".part") {
  const std::lock_guard guard(hdf5_lock());
  make_directory(path_.parent_path());
  check(nc_create(part_.c_str(), NC_NETCDF4 | NC_CLOBBER, &id_), part_, "cannot be written");
}

NetcdfWriter::~NetcdfWriter() {
  const std::lock_guard guard(hdf5_lock());
  if (id_ >= 0) {
    nc_abort(id_);
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
  }
}

void NetcdfWriter::attribute(const std::string& name, const std::string& text) {
  const std::lock_guard guard(hdf5_lock());
  put_attributes(id_, NC_GLOBAL, {{name, text}}, part_);
}

void NetcdfWriter::dimension(const std::string& name, std::size_t size) {
  const std::lock_guard guard(hdf5_lock());
  int dim = 0;
  check(nc_def_dim(id_, name.c_str(), size, &dim), part_, "dimension " + name);
  dimensions_[name] = {dim, size};
}

int NetcdfWriter::define(const std::string& name, const std::vector<std::string>& dims, int type, std::size_t given, const Attributes& attributes) {
  std::vector<int> ids;
  std::size_t size = 1;
  for (const auto& d : dims) {
    expect(dimensions_.contains(d), "netCDF dimension is declared before use");
    ids.push_back(dimensions_[d].first);
    size *= dimensions_[d].second;
  }
  expect(size == given, "netCDF variable has the size of its dimensions");
  int variable = 0;
  check(nc_def_var(id_, name.c_str(), type, int(ids.size()), ids.data(), &variable), part_, "variable " + name);
  if (size > 65536 && type != NC_STRING) check(nc_def_var_deflate(id_, variable, 1, 1, 1), part_, "compression of " + name);
  put_attributes(id_, variable, attributes, part_);
  return variable;
}

void NetcdfWriter::variable(const std::string& name, const std::vector<std::string>& dims, std::span<const double> values, const Attributes& attributes) {
  const std::lock_guard guard(hdf5_lock());
  const int v = define(name, dims, NC_DOUBLE, values.size(), attributes);
  const double fill = std::numeric_limits<double>::quiet_NaN();
  check(nc_def_var_fill(id_, v, NC_FILL, &fill), part_, "fill value of " + name);
  if (!values.empty()) check(nc_put_var_double(id_, v, values.data()), part_, "writing " + name);
}
void NetcdfWriter::variable(const std::string& name, const std::vector<std::string>& dims, std::span<const float> values, const Attributes& attributes) {
  const std::lock_guard guard(hdf5_lock());
  const int v = define(name, dims, NC_FLOAT, values.size(), attributes);
  const float fill = std::numeric_limits<float>::quiet_NaN();
  check(nc_def_var_fill(id_, v, NC_FILL, &fill), part_, "fill value of " + name);
  if (!values.empty()) check(nc_put_var_float(id_, v, values.data()), part_, "writing " + name);
}
void NetcdfWriter::variable(const std::string& name, const std::vector<std::string>& dims, std::span<const int> values, const Attributes& attributes) {
  const std::lock_guard guard(hdf5_lock());
  const int v = define(name, dims, NC_INT, values.size(), attributes);
  if (!values.empty()) check(nc_put_var_int(id_, v, values.data()), part_, "writing " + name);
}
void NetcdfWriter::variable(const std::string& name, const std::vector<std::string>& dims, std::span<const std::string> values, const Attributes& attributes) {
  const std::lock_guard guard(hdf5_lock());
  const int v = define(name, dims, NC_STRING, values.size(), attributes);
  std::vector<const char*> pointers;
  for (const auto& s : values) pointers.push_back(s.c_str());
  if (!values.empty()) check(nc_put_var_string(id_, v, pointers.data()), part_, "writing " + name);
}

void NetcdfWriter::flags(const std::string& name, const std::vector<std::string>& dims, std::span<const int> values, std::span<const std::string> meanings) {
  const std::lock_guard guard(hdf5_lock());
  const int v = define(name, dims, NC_INT, values.size(), {{"flag_meanings", join(meanings, " ")}});
  std::vector<int> flag_values;
  for (std::size_t i = 0; i < meanings.size(); ++i) flag_values.push_back(int(i));
  check(nc_put_att_int(id_, v, "flag_values", NC_INT, flag_values.size(), flag_values.data()), part_, "flag_values of " + name);
  if (!values.empty()) check(nc_put_var_int(id_, v, values.data()), part_, "writing " + name);
}

void NetcdfWriter::commit() {
  const std::lock_guard guard(hdf5_lock());
  const int id = std::exchange(id_, -1);
  check(nc_close(id), part_, "closing");
  rename_durably(part_, path_);
}

NetcdfReader::NetcdfReader(std::filesystem::path path) : path_(std::move(path)) {
  const std::lock_guard guard(hdf5_lock());
  check(nc_open(path_.c_str(), NC_NOWRITE, &id_), path_, "cannot be read as netCDF");
}

NetcdfReader::~NetcdfReader() {
  const std::lock_guard guard(hdf5_lock());
  if (id_ >= 0) nc_close(id_);
}

int NetcdfReader::variable_id(const std::string& variable) const {
  int v = 0;
  if (nc_inq_varid(id_, variable.c_str(), &v) != NC_NOERR) throw InputError({.problem = "has no variable \"" + variable + "\"", .file = path_.string()});
  return v;
}

bool NetcdfReader::has(const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  int v = 0;
  return nc_inq_varid(id_, variable.c_str(), &v) == NC_NOERR;
}

std::vector<std::string> NetcdfReader::dimensions(const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  const int v = variable_id(variable);
  int n = 0;
  check(nc_inq_varndims(id_, v, &n), path_, "dimensions of " + variable);
  std::vector<int> ids(std::size_t(n), 0);
  check(nc_inq_vardimid(id_, v, ids.data()), path_, "dimensions of " + variable);
  std::vector<std::string> names;
  for (const int d : ids) {
    char name[NC_MAX_NAME + 1] = {};
    check(nc_inq_dimname(id_, d, name), path_, "dimensions of " + variable);
    names.emplace_back(name);
  }
  return names;
}

std::vector<std::size_t> NetcdfReader::shape(const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  std::vector<std::size_t> sizes;
  for (const auto& d : dimensions(variable)) {
    int dim = 0;
    std::size_t size = 0;
    check(nc_inq_dimid(id_, d.c_str(), &dim), path_, "dimension " + d);
    check(nc_inq_dimlen(id_, dim, &size), path_, "dimension " + d);
    sizes.push_back(size);
  }
  return sizes;
}

namespace {
std::size_t product(const std::vector<std::size_t>& sizes) {
  std::size_t n = 1;
  for (const auto s : sizes) n *= s;
  return n;
}
}  // namespace

std::vector<double> NetcdfReader::doubles(const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  std::vector<double> out(product(shape(variable)));
  if (!out.empty()) check(nc_get_var_double(id_, variable_id(variable), out.data()), path_, "reading " + variable);
  return out;
}
std::vector<int> NetcdfReader::integers(const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  std::vector<int> out(product(shape(variable)));
  if (!out.empty()) check(nc_get_var_int(id_, variable_id(variable), out.data()), path_, "reading " + variable);
  return out;
}
std::vector<std::string> NetcdfReader::strings(const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  std::vector<char*> raw(product(shape(variable)));
  if (raw.empty()) return {};
  check(nc_get_var_string(id_, variable_id(variable), raw.data()), path_, "reading " + variable);
  std::vector<std::string> out;
  for (const char* s : raw) out.emplace_back(s ? s : "");
  nc_free_string(raw.size(), raw.data());
  return out;
}

std::string NetcdfReader::attribute(const std::string& name, const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  const int v = variable.empty() ? NC_GLOBAL : variable_id(variable);
  std::size_t size = 0;
  if (nc_inq_attlen(id_, v, name.c_str(), &size) != NC_NOERR) return "";
  std::string text(size, '\0');
  return nc_get_att_text(id_, v, name.c_str(), text.data()) == NC_NOERR ? text : "";
}

}  // namespace calomel
