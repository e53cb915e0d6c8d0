// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

/// Pieces of the page.
namespace palpate::reproduction {

/// | a | b |, columns padded so that the text is readable as it is. All rows of the header's length.
struct MarkdownTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows = {};

  std::string text() const;
};

/// "3.24e-05", "0.0144"; the digits that a comparison needs.
std::string short_number(double value);

/// ![caption](name.svg)
std::string picture(const std::string& name, const std::string& caption);

/// "1.3 times" of ours over theirs, "below" where it is not above.
std::string against(double ours, double theirs);

}  // namespace palpate::reproduction
