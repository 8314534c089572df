#pragma once
/// Artefacts on disk: hashes, atomic writes, JSON files. What an artefact comes from: provenance.hpp.
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/options.hpp"

namespace calomel {

/// The program's version, e.g. "0.2.0".
extern const char* const version;

/// FNV-1a, 64 bit (Fowler, Noll and Vo).
std::uint64_t hash_of(std::string_view bytes);
/// The same as 16 hexadecimal digits.
std::string hash_text(std::string_view text);
/// Hash of a file's bytes. Errors: InputError when it cannot be read.
std::string hash_file(const std::filesystem::path& path);

/// Makes the directory and its parents. Errors: InputError naming it.
void make_directory(const std::filesystem::path& path);
/// Waits until what the file holds is on disk.
void sync_to_disk(const std::filesystem::path& path);
/// Syncs `part` to disk and renames it to `path`, so that `path` is whole or absent at every instant.
void rename_durably(const std::filesystem::path& part, const std::filesystem::path& path);
/// Writes `text` to `path` through a temporary file. Errors: InputError.
void write_atomically(const std::filesystem::path& path, std::string_view text);
/// Whole file. Errors: InputError.
std::string read_text(const std::filesystem::path& path);
/// JSON of a file. Errors: InputError naming file and line.
Json read_json(const std::filesystem::path& path);
/// Pretty JSON, atomically; what is no UTF-8 is replaced, a NaN or infinity is a contract failure (JSON has none).
void write_json(const std::filesystem::path& path, const Json& json);

/// Renames the file to `name.old-N` (never deletes); nothing happens when it is absent.
void set_aside(const std::filesystem::path& path);

}  // namespace calomel
