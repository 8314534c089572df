#pragma once
/// pagmo's classes by name only: its headers bring in Boost's serialisation, a second of compiling in every file that sees them.

namespace pagmo {
class algorithm;
class population;
}  // namespace pagmo
