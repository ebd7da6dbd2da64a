// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/error_quantiles.h"

#include <fmt/format.h>

namespace otg::cli {

void addErrorQuantiles(Json& row, const std::string& name, const truth::Errors& errors, int percentile) {
  const auto value = [&](double part) { return errors.count() == 0 ? Json() : Json(errors.quantile(part)); };
  row[name + "_median"] = value(0.5);
  row[name + fmt::format("_p{}", percentile)] = value(percentile / 100.0);
  row[name + "_max"] = value(1);
}

std::string errorQuantilesInWords(const Json& row, const std::string& name) {
  std::string words;
  for (const char* part : {"_median", "_p99", "_max"}) {
    const Json& value = row[name + part];
    if (value.is_null()) return "-";
    words += (words.empty() ? "" : " / ") + fmt::format("{:.2g}", value.get<double>());
  }
  return words;
}

}  // namespace otg::cli
