// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace palpate {

/// Bad input: a file, an option or a parameter that cannot be used. The message stands alone: it names the place, the
/// value found and what was expected. The command line prints it and ends with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace palpate
