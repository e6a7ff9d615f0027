#include "bench/reproduce/page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "burnish/formats/image_file.h"

namespace burnish::tools {
namespace {

/// The inverse of srgb_from_linear: write_png encodes, and these pictures are encoded already.
float linear_from_srgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

Image decoded(Image picture) {
  for (Rgb& pixel : picture.pixels) pixel = pixel.unaryExpr(&linear_from_srgb);
  return picture;
}

std::string cell_text(const BenchRow& row, const std::string& column) {
  if (!row.contains(column) || row[column].is_null()) return "";
  const auto& value = row[column];
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_number_float()) return value.dump();
  // Not 1.234e+04 for times and counts.
  const double number = value.get<double>();
  return std::abs(number) >= 1000 && std::abs(number) < 1e7 ? fmt::format("{:.0f}", number)
                                                            : fmt::format("{:.4g}", number);
}

std::string markdown_table(const std::vector<BenchRow>& rows) {
  std::vector<std::string> columns;
  for (const BenchRow& row : rows)
    for (const auto& [name, value] : row.items())
      if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
  std::string same, head, rule;
  std::vector<std::string> lines(rows.size());
  for (const std::string& column : columns) {
    const std::string first = cell_text(rows.front(), column);
    const bool constant = std::all_of(rows.begin(), rows.end(), [&](const BenchRow& row) {
      return cell_text(row, column) == first;
    });
    if (constant && rows.size() > 1) {
      same += fmt::format("{}{}: {}", same.empty() ? "" : "; ", column, first);
      continue;
    }
    head += fmt::format("| {} ", column);
    rule += rows.front().value(column, BenchRow()).is_string() ? "|---" : "|---:";
    for (size_t i = 0; i < rows.size(); ++i)
      lines[i] += fmt::format("| {} ", cell_text(rows[i], column));
  }
  return fmt::format("{}{}{}|\n{}|\n{} |\n", same, same.empty() ? "" : "\n\n", head, rule,
                     fmt::join(lines, "|\n"));
}

std::string seconds_text(double seconds) {
  return seconds < 10 ? fmt::format("{:.1f} s", seconds) : fmt::format("{:.0f} s", seconds);
}

std::string figure_section(const MadeFigure& made, const std::string& pictures) {
  const Figure& figure = *made.figure;
  std::string text = fmt::format("## {}\n\n**The paper** {}\n", figure.title, figure.paper_shows);
  for (const FigurePicture& picture : made.result.pictures)
    text += fmt::format("\n![{}]({}/{}.png)\n\n*{}*\n", figure.title, pictures, picture.name,
                        picture.caption);
  if (!made.result.rows.empty()) text += "\n" + markdown_tables(made.result.rows);
  return text + fmt::format("\n**We** {}\n\n`burnish-bench reproduce {}`, {}.\n", made.result.found,
                            figure.name, seconds_text(made.seconds));
}

}  // namespace

void write_figure_files(const MadeFigure& made, const std::string& folder) {
  const std::filesystem::path path(folder);
  for (const FigurePicture& picture : made.result.pictures)
    write_png(decoded(picture.picture), (path / (picture.name + ".png")).string());
  if (!made.result.rows.empty())
    write_text((path / (made.figure->name + ".csv")).string(), format_csv(made.result.rows));
}

std::string markdown_tables(const std::vector<BenchRow>& rows) {
  std::vector<std::pair<std::string, std::vector<BenchRow>>> tables;
  for (BenchRow row : rows) {
    const std::string what = row.value("what", "");
    row.erase("what");
    auto table = std::find_if(tables.begin(), tables.end(),
                              [&](const auto& known) { return known.first == what; });
    if (table == tables.end()) table = tables.insert(tables.end(), {what, {}});
    table->second.push_back(std::move(row));
  }
  std::string text;
  for (const auto& [what, own] : tables) {
    if (!text.empty()) text += "\n";
    if (!what.empty()) text += fmt::format("{}:\n\n", what);
    text += markdown_table(own);
  }
  return text;
}

std::string reproduction_page(std::span<const MadeFigure> figures, const std::string& pictures,
                              const nlohmann::ordered_json& machine) {
  double seconds = 0;
  for (const MadeFigure& made : figures) seconds += made.seconds;
  std::string text = fmt::format(
      "# The papers' figures, made again\n\n"
      "Written by `burnish-bench reproduce`; not by hand. {} with {} threads, {}; {} in all, with "
      "truths that were not kept from an earlier run computed. What is measured, and how, is in "
      "[harness.md](harness.md). The numbers of each figure are beside its pictures as CSV.\n",
      machine["cpu"].get<std::string>(), machine["threads"].dump(),
      machine["compiler"].get<std::string>(), seconds_text(seconds));
  for (const MadeFigure& made : figures) text += "\n" + figure_section(made, pictures);
  return text;
}

}  // namespace burnish::tools
