#include <iostream>

#include "apps/case_reference.hpp"

/// Prints docs/case_reference.md.
int main() { std::cout << calomel::case_reference(); }
