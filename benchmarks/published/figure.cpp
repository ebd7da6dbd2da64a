// SPDX-License-Identifier: BSD-3-Clause
// Stacked columns as an SVG file.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "published/tables.h"

namespace otg::cli {
namespace {

constexpr double kLeft = 50, kTop = 40, kHeight = 300, kWidth = 70, kGap = 30, kLegend = 150;
constexpr const char* kColors[] = {"#4e79a7", "#f28e2b", "#e15759", "#76b7b2", "#59a14f", "#edc948",
                                   "#b07aa1", "#ff9da7", "#9c755f", "#bab0ac", "#2f4b7c", "#a05195"};

/// The parts that are there in any column, in their order.
std::vector<std::string> namesOf(const StackedColumns& figure) {
  std::vector<std::string> names;
  for (const StackedColumns::Column& column : figure.columns) {
    for (const QueryStage& part : column.parts) {
      if (part.percent > 0 && std::find(names.begin(), names.end(), part.name) == names.end()) {
        names.push_back(part.name);
      }
    }
  }
  return names;
}

std::string box(double x, double y, double width, double height, const char* color) {
  return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>\n", x, y, width,
                     height, color);
}

std::string text(double x, double y, const char* anchor, const std::string& words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, words);
}

}  // namespace

void writeSvg(const StackedColumns& figure, const std::string& file) {
  const std::vector<std::string> names = namesOf(figure);
  const double across = kLeft + static_cast<double>(figure.columns.size()) * (kWidth + kGap);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" height=\"{:.0f}\" font-family=\"sans-serif\" "
      "font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      std::max(across + kLegend, kLeft + 7.0 * static_cast<double>(figure.title.size())), kTop + kHeight + 40);
  out += text(kLeft, 20, "start", figure.title);
  for (const int percent : {0, 25, 50, 75, 100}) {
    const double y = kTop + kHeight * (1 - percent / 100.0);
    out += fmt::format("<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"#ddd\"/>\n", kLeft, y, across);
    out += text(kLeft - 6, y + 4, "end", fmt::format("{} %", percent));
  }
  for (std::size_t i = 0; i < figure.columns.size(); ++i) {
    const double x = kLeft + kGap / 2 + static_cast<double>(i) * (kWidth + kGap);
    double y = kTop + kHeight;
    for (std::size_t k = 0; k < names.size(); ++k) {
      for (const QueryStage& part : figure.columns[i].parts) {
        if (part.name != names[k]) continue;
        const double height = kHeight * part.percent / 100;
        y -= height;
        out += box(x, y, kWidth, height, kColors[k % std::size(kColors)]);
      }
    }
    out += text(x + kWidth / 2, kTop + kHeight + 18, "middle", figure.columns[i].name);
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    const double y = kTop + 18 * static_cast<double>(names.size() - 1 - k);
    out += box(across + 10, y, 12, 12, kColors[k % std::size(kColors)]);
    out += text(across + 28, y + 10, "start", names[k]);
  }
  std::ofstream stream(file);
  stream << out << "</svg>\n";
  stream.close();
  if (!stream) throw InputError(file + ": cannot be written");
}

}  // namespace otg::cli
