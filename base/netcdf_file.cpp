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

void check(int status, const std::filesystem::path& path, const std::string& doing,
           const std::string& suggestion = "check the path, the free space and the format") {
  if (status != NC_NOERR) throw InputError({.problem = doing + ": " + nc_strerror(status), .suggestion = suggestion, .file = path.string()});
}

void put_attributes(int id, int variable, const Attributes& attributes, const std::filesystem::path& path) {
  for (const auto& [name, text] : attributes) check(nc_put_att_text(id, variable, name.c_str(), text.size(), text.c_str()), path, "attribute " + name);
}

}  // namespace

NetcdfWriter::NetcdfWriter(std::filesystem::path path) : path_(std::move(path)), part_(path_.string() + ".part") {
  const std::lock_guard guard(hdf5_lock());
  make_directory(path_.parent_path());
  check(nc_create(part_.c_str(), NC_NETCDF4 | NC_CLOBBER, &id_), part_, "cannot be written");
  at_ = id_;
}

NetcdfWriter::~NetcdfWriter() {
  const std::lock_guard guard(hdf5_lock());
  if (id_ >= 0) {
    nc_abort(id_);
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
  }
}

void NetcdfWriter::group(const std::string& name) {
  const std::lock_guard guard(hdf5_lock());
  at_ = id_;
  if (!name.empty() && nc_inq_grp_ncid(id_, name.c_str(), &at_) != NC_NOERR) check(nc_def_grp(id_, name.c_str(), &at_), part_, "group " + name);
}

void NetcdfWriter::attribute(const std::string& name, const std::string& text) {
  const std::lock_guard guard(hdf5_lock());
  put_attributes(at_, NC_GLOBAL, {{name, text}}, part_);
}

void NetcdfWriter::dimension(const std::string& name, std::size_t size) {
  const std::lock_guard guard(hdf5_lock());
  int dim = 0;
  check(nc_def_dim(at_, name.c_str(), size, &dim), part_, "dimension " + name);
  dimensions_[at_][name] = {dim, size};
}

int NetcdfWriter::define(const std::string& name, const std::vector<std::string>& dims, int type, std::size_t given, const Attributes& attributes) {
  std::vector<int> ids;
  std::size_t size = 1;
  for (const auto& d : dims) {
    const auto& here = dimensions_[at_].contains(d) ? dimensions_[at_] : dimensions_[id_];
    expect(here.contains(d), "netCDF dimension is declared before use");
    ids.push_back(here.at(d).first);
    size *= here.at(d).second;
  }
  expect(size == given, "netCDF variable has the size of its dimensions");
  int variable = 0;
  check(nc_def_var(at_, name.c_str(), type, int(ids.size()), ids.data(), &variable), part_, "variable " + name);
  if (size > 65536 && type != NC_STRING) check(nc_def_var_deflate(at_, variable, 1, 1, 1), part_, "compression of " + name);
  put_attributes(at_, variable, attributes, part_);
  return variable;
}

void NetcdfWriter::variable(const std::string& name, const std::vector<std::string>& dims, std::span<const double> values, const Attributes& attributes) {
  const std::lock_guard guard(hdf5_lock());
  const int v = define(name, dims, NC_DOUBLE, values.size(), attributes);
  const double fill = std::numeric_limits<double>::quiet_NaN();
  check(nc_def_var_fill(at_, v, NC_FILL, &fill), part_, "fill value of " + name);
  if (!values.empty()) check(nc_put_var_double(at_, v, values.data()), part_, "writing " + name);
}
void NetcdfWriter::variable(const std::string& name, const std::vector<std::string>& dims, std::span<const float> values, const Attributes& attributes) {
  const std::lock_guard guard(hdf5_lock());
  const int v = define(name, dims, NC_FLOAT, values.size(), attributes);
  const float fill = std::numeric_limits<float>::quiet_NaN();
  check(nc_def_var_fill(at_, v, NC_FILL, &fill), part_, "fill value of " + name);
  if (!values.empty()) check(nc_put_var_float(at_, v, values.data()), part_, "writing " + name);
}
void NetcdfWriter::variable(const std::string& name, const std::vector<std::string>& dims, std::span<const int> values, const Attributes& attributes) {
  const std::lock_guard guard(hdf5_lock());
  const int v = define(name, dims, NC_INT, values.size(), attributes);
  if (!values.empty()) check(nc_put_var_int(at_, v, values.data()), part_, "writing " + name);
}
void NetcdfWriter::variable(const std::string& name, const std::vector<std::string>& dims, std::span<const std::int8_t> values, const Attributes& attributes) {
  const std::lock_guard guard(hdf5_lock());
  const int v = define(name, dims, NC_BYTE, values.size(), attributes);
  if (!values.empty()) check(nc_put_var_schar(at_, v, values.data()), part_, "writing " + name);
}
void NetcdfWriter::variable(const std::string& name, const std::vector<std::string>& dims, std::span<const std::string> values, const Attributes& attributes) {
  const std::lock_guard guard(hdf5_lock());
  const int v = define(name, dims, NC_STRING, values.size(), attributes);
  std::vector<const char*> pointers;
  for (const auto& s : values) pointers.push_back(s.c_str());
  if (!values.empty()) check(nc_put_var_string(at_, v, pointers.data()), part_, "writing " + name);
}

void NetcdfWriter::flags(const std::string& name, const std::vector<std::string>& dims, std::span<const int> values, std::span<const std::string> meanings) {
  const std::lock_guard guard(hdf5_lock());
  const int v = define(name, dims, NC_INT, values.size(), {{"flag_meanings", join(meanings, " ")}});
  std::vector<int> flag_values;
  for (std::size_t i = 0; i < meanings.size(); ++i) flag_values.push_back(int(i));
  check(nc_put_att_int(at_, v, "flag_values", NC_INT, flag_values.size(), flag_values.data()), part_, "flag_values of " + name);
  if (!values.empty()) check(nc_put_var_int(at_, v, values.data()), part_, "writing " + name);
}

void NetcdfWriter::commit() {
  const std::lock_guard guard(hdf5_lock());
  const int id = std::exchange(id_, -1);
  check(nc_close(id), part_, "closing");
  rename_durably(part_, path_);
}

NetcdfReader::NetcdfReader(std::filesystem::path path) : path_(std::move(path)) {
  const std::lock_guard guard(hdf5_lock());
  check(nc_open(path_.c_str(), NC_NOWRITE, &id_), path_, "cannot be read as netCDF",
        "check the path and the format; an artefact of this program that is damaged is set aside by --fresh");
}

NetcdfReader::~NetcdfReader() {
  const std::lock_guard guard(hdf5_lock());
  if (id_ >= 0) nc_close(id_);
}

int NetcdfReader::group_id(const std::string& group) const {
  int id = id_;
  if (!group.empty() && nc_inq_grp_full_ncid(id_, group.c_str(), &id) != NC_NOERR)
    throw InputError({.problem = "has no group \"" + group + "\"", .file = path_.string()});
  return id;
}

NetcdfReader::Place NetcdfReader::place(const std::string& variable) const {
  const auto slash = variable.rfind('/');
  Place p{slash == std::string::npos ? id_ : group_id(variable.substr(0, slash)), NC_GLOBAL};
  const std::string name = slash == std::string::npos ? variable : variable.substr(slash + 1);
  if (!name.empty() && nc_inq_varid(p.group, name.c_str(), &p.variable) != NC_NOERR)
    throw InputError({.problem = "has no variable \"" + variable + "\"", .file = path_.string()});
  return p;
}

bool NetcdfReader::has(const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  const auto slash = variable.rfind('/');
  int group = id_, v = 0;
  if (slash != std::string::npos && nc_inq_grp_full_ncid(id_, variable.substr(0, slash).c_str(), &group) != NC_NOERR) return false;
  return nc_inq_varid(group, variable.substr(slash == std::string::npos ? 0 : slash + 1).c_str(), &v) == NC_NOERR;
}

std::vector<std::string> NetcdfReader::groups() const {
  const std::lock_guard guard(hdf5_lock());
  int n = 0;
  check(nc_inq_grps(id_, &n, nullptr), path_, "groups");
  std::vector<int> ids(std::size_t(n), 0);
  check(nc_inq_grps(id_, &n, ids.data()), path_, "groups");
  std::vector<std::string> names;
  for (const int g : ids) {
    char name[NC_MAX_NAME + 1] = {};
    check(nc_inq_grpname(g, name), path_, "groups");
    names.emplace_back(name);
  }
  return names;
}

std::vector<std::string> NetcdfReader::variables(const std::string& group) const {
  const std::lock_guard guard(hdf5_lock());
  const int g = group_id(group);
  int n = 0;
  check(nc_inq_nvars(g, &n), path_, "variables");
  std::vector<std::string> names;
  for (int v = 0; v < n; ++v) {
    char name[NC_MAX_NAME + 1] = {};
    check(nc_inq_varname(g, v, name), path_, "variables");
    names.emplace_back(name);
  }
  return names;
}

namespace {
std::vector<int> dimension_ids(int group, int variable, const std::filesystem::path& path, const std::string& name) {
  int n = 0;
  check(nc_inq_varndims(group, variable, &n), path, "dimensions of " + name);
  std::vector<int> ids(std::size_t(n), 0);
  check(nc_inq_vardimid(group, variable, ids.data()), path, "dimensions of " + name);
  return ids;
}
}  // namespace

std::vector<std::string> NetcdfReader::dimensions(const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  const Place p = place(variable);
  std::vector<std::string> names;
  for (const int d : dimension_ids(p.group, p.variable, path_, variable)) {
    char name[NC_MAX_NAME + 1] = {};
    check(nc_inq_dimname(p.group, d, name), path_, "dimensions of " + variable);
    names.emplace_back(name);
  }
  return names;
}

std::vector<std::size_t> NetcdfReader::shape(const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  const Place p = place(variable);
  std::vector<std::size_t> sizes;
  for (const int d : dimension_ids(p.group, p.variable, path_, variable)) {
    std::size_t size = 0;
    check(nc_inq_dimlen(p.group, d, &size), path_, "dimensions of " + variable);
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
  const Place p = place(variable);
  if (!out.empty()) check(nc_get_var_double(p.group, p.variable, out.data()), path_, "reading " + variable);
  return out;
}
std::vector<int> NetcdfReader::integers(const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  std::vector<int> out(product(shape(variable)));
  const Place p = place(variable);
  if (!out.empty()) check(nc_get_var_int(p.group, p.variable, out.data()), path_, "reading " + variable);
  return out;
}
std::vector<std::string> NetcdfReader::strings(const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  std::vector<char*> raw(product(shape(variable)));
  if (raw.empty()) return {};
  const Place p = place(variable);
  check(nc_get_var_string(p.group, p.variable, raw.data()), path_, "reading " + variable);
  std::vector<std::string> out;
  for (const char* s : raw) out.emplace_back(s ? s : "");
  nc_free_string(raw.size(), raw.data());
  return out;
}

bool NetcdfReader::holds_text(const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  const Place p = place(variable);
  nc_type type = 0;
  check(nc_inq_vartype(p.group, p.variable, &type), path_, "type of " + variable);
  return type == NC_STRING || type == NC_CHAR;
}

std::string NetcdfReader::attribute(const std::string& name, const std::string& variable) const {
  const std::lock_guard guard(hdf5_lock());
  const Place p = variable.empty() ? Place{id_, NC_GLOBAL} : place(variable);
  std::size_t size = 0;
  if (nc_inq_attlen(p.group, p.variable, name.c_str(), &size) != NC_NOERR) return "";
  std::string text(size, '\0');
  return nc_get_att_text(p.group, p.variable, name.c_str(), text.data()) == NC_NOERR ? text : "";
}

}  // namespace calomel
