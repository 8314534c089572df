#include "base/artefact.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "base/identity.hpp"
#include "base/json.hpp"
#include "base/provenance.hpp"

namespace calomel {

const char* const version = CALOMEL_VERSION;

std::uint64_t hash_of(std::string_view bytes) {
  std::uint64_t h = 14695981039346656037ull;
  for (const char c : bytes) h = (h ^ std::uint8_t(c)) * 1099511628211ull;
  return h;
}
std::string hash_text(std::string_view text) { return fmt::format("{:016x}", hash_of(text)); }

std::string hash_file(const std::filesystem::path& path) { return hash_text(read_text(path)); }

void make_directory(const std::filesystem::path& path) {
  if (path.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error && !std::filesystem::is_directory(path))
    throw InputError({.problem = "the directory cannot be made: " + error.message(), .suggestion = "choose another --out", .file = path.string()});
}

void sync_to_disk(const std::filesystem::path& path) {
  if (const int fd = ::open(path.c_str(), O_RDONLY); fd >= 0) {
    ::fsync(fd);
    ::close(fd);
  }
}

void rename_durably(const std::filesystem::path& part, const std::filesystem::path& path) {
  sync_to_disk(part);
  std::error_code error;
  std::filesystem::rename(part, path, error);
  if (error) throw InputError({.problem = "cannot be written: " + error.message(), .file = path.string()});
}

void write_atomically(const std::filesystem::path& path, std::string_view text) {
  make_directory(path.parent_path());
  const std::filesystem::path part = path.string() + ".part";
  {
    std::ofstream out(part, std::ios::binary);
    out.write(text.data(), std::streamsize(text.size()));
    out.close();
    if (!out) throw InputError({.problem = "cannot be written", .suggestion = "check the free space and the rights", .file = path.string()});
  }
  rename_durably(part, path);
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path)) throw InputError({.problem = "cannot be opened", .suggestion = "check the name", .file = path.string()});
  std::stringstream text;
  text << in.rdbuf();
  return std::move(text).str();
}

Json read_json(const std::filesystem::path& path) {
  try {
    return Json::parse(read_text(path));
  } catch (const Json::exception& e) {
    throw InputError({.problem = std::string("not valid JSON: ") + e.what(), .suggestion = "make it again with --fresh", .file = path.string()});
  }
}

namespace {
void expect_finite(const Json& j, const std::string& place) {
  if (j.is_number_float()) expect(std::isfinite(j.get<double>()), fmt::format("the number {} of a JSON artefact is finite", place).c_str());
  if (j.is_structured())
    for (const auto& [key, item] : j.items()) expect_finite(item, place + '/' + key);
}
}  // namespace

void write_json(const std::filesystem::path& path, const Json& json) {
  expect_finite(json, "");
  write_atomically(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::string Provenance::identity() const { return hash_text(Json{{"stage", stage}, {"seed", seed}, {"options", options}, {"inputs", inputs}}.dump()); }

namespace {
/// The options of a written provenance that are part of the identity: older releases also recorded options that do not change the result.
Json identifying_options(const Json& written) {
  Json options = written.value("options", Json::object());
  if (!options.contains("solver") || !options["solver"].is_object()) return options;
  options["solver"].erase("checkpoint");  // how often a run is saved
  if (written.value("stage", "") != "simulate")
    for (const char* key : {"booking", "energy_balance"}) options["solver"].erase(key);
  return options;
}
}  // namespace

std::string identity_of(const Json& written) {
  Json options = identifying_options(written);
  if (options == written.value("options", Json::object())) return written.value("identity", "");
  return Provenance{.stage = written.value("stage", ""),
                    .options = std::move(options),
                    .seed = written.value("seed", std::uint64_t{0}),
                    .inputs = written.value("inputs", std::map<std::string, std::string>{})}
      .identity();
}

Json Provenance::json() const {
  return {{"program", "calomel"}, {"version", version}, {"stage", stage}, {"seed", seed}, {"options", options}, {"inputs", inputs}, {"identity", identity()}};
}

std::vector<std::string> changed_keys(const Json& before, const Json& now, const std::string& prefix) {
  std::vector<std::string> keys;
  if (!before.is_object() || !now.is_object()) {
    if (before != now) keys.push_back(prefix);
    return keys;
  }
  const auto name = [&](const std::string& k) { return prefix.empty() ? k : prefix + '.' + k; };
  for (const auto& [k, v] : before.items()) {
    const auto inner = now.contains(k) ? changed_keys(v, now[k], name(k)) : std::vector<std::string>{name(k)};
    keys.insert(keys.end(), inner.begin(), inner.end());
  }
  for (const auto& [k, v] : now.items())
    if (!before.contains(k)) keys.push_back(name(k));
  return keys;
}

Reuse reusable(const std::filesystem::path& path, const Provenance& now) {
  if (!std::filesystem::exists(path)) return Reuse::nothing_there;
  expect_same_provenance(read_json(path).value("provenance", Json::object()), now, path);
  return Reuse::matches;
}

void expect_same_provenance(const Json& before, const Provenance& now, const std::filesystem::path& file) {
  if (identity_of(before) == now.identity()) return;
  auto keys = changed_keys(identifying_options(before), now.options);
  for (const auto& k : changed_keys(before.value("inputs", Json::object()), Json(now.inputs))) keys.push_back("the input " + k);
  if (before.value("seed", std::uint64_t{0}) != now.seed) keys.push_back("the seed");
  if (before.value("stage", "") != now.stage) keys.push_back(fmt::format("the stage ({}, now {})", before.value("stage", "none"), now.stage));
  if (keys.empty()) keys.push_back("the identity (the options, inputs and seed are equal: the file was edited or is damaged)");
  throw InputError({.problem = "was made with other settings; changed: " + join(keys),
                    .suggestion = "use another --out, or --fresh to set the old artefacts aside",
                    .file = file.string()});
}

void set_aside(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return;
  for (int n = 1;; ++n) {
    const std::filesystem::path target = fmt::format("{}.old-{}", path.string(), n);
    if (std::filesystem::exists(target)) continue;
    std::filesystem::rename(path, target);
    return;
  }
}

}  // namespace calomel
