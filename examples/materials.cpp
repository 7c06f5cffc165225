// The built-in materials, and what is said of a name that is none.
#include <intaglio/material.h>
#include <intaglio/version.h>

#include <iostream>

int main() {
  std::cout << "Intaglio " << intaglio::version() << '\n';
  for (const intaglio::Material& m : intaglio::materials())
    std::cout << m.name << ": " << m.density << " kg/m^3, " << m.youngs_modulus << " Pa\n";
  const auto misspelt = intaglio::find_material("stele");
  std::cout << misspelt.error() << '\n';
  return misspelt ? 1 : 0;
}
