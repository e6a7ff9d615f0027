#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "tradeoff/report_page.h"

namespace burnish::tools {
namespace {

namespace fs = std::filesystem;

/// A page with more would not be read, nor shown by a browser.
constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 26;

std::string read_bytes(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) throw Error(ErrorKind::input, path.string(), "cannot be read");
  if (size > kMaxFileBytes)
    throw Error(ErrorKind::input, path.string(),
                fmt::format("found {} bytes, expected at most {}", size, kMaxFileBytes));
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string read_png(const fs::path& path) {
  std::string bytes = read_bytes(path);
  if (!bytes.starts_with("\x89PNG\r\n\x1a\n"))
    throw Error(ErrorKind::input, path.string(), "found no PNG signature, expected a PNG file");
  return bytes;
}

ReportSweep read_sweep_folder(const fs::path& folder) {
  const std::string path = (folder / "tradeoff.json").string();
  ReportSweep result{read_sweep(path), {}};
  if (!result.sweep.pictures.is_array()) return result;  // interrupted before them
  for (const auto& picture : result.sweep.pictures) {
    const bool named = picture.is_object() && picture.contains("file") &&
                       picture["file"].is_string() && picture.contains("name") &&
                       picture["name"].is_string();
    const fs::path name = named ? picture["file"].get<std::string>() : "";
    if (!named || name.has_parent_path())
      throw Error(ErrorKind::input, path,
                  "pictures: found one without the names of its row and of a file of the folder");
    std::string caption = picture["name"].get<std::string>();
    for (const auto& [key, format] :
         {std::pair("relative_l2", "relative L2 {:.3f}"), std::pair("flip", "FLIP {:.4f}"),
          std::pair("psnr_db", "PSNR {:.1f} dB")})
      if (picture.contains(key) && picture[key].is_number())
        caption += "; " + fmt::format(fmt::runtime(format), picture[key].get<double>());
    result.pictures.push_back({caption, read_png(folder / name)});
  }
  return result;
}

/// Figures by the names of their files, and the text beside them.
void read_figures(const fs::path& folder, Report& report) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<ReportFigure> figures;
  for (const fs::path& file : files) {
    if (file.extension() == ".csv")
      figures.push_back({file.stem().string(), parse_csv(file.string(), read_bytes(file)), {}});
    if (file.extension() == ".md") report.notes += read_bytes(file) + "\n";
  }
  for (const fs::path& file : files) {
    if (file.extension() != ".png") continue;
    const std::string stem = file.stem().string();
    // fig11-none.png belongs to fig11.csv.
    auto figure = std::find_if(figures.begin(), figures.end(), [&](const ReportFigure& known) {
      return stem == known.name || stem.starts_with(known.name + "-") ||
             stem.starts_with(known.name + "_") || stem.starts_with(known.name + ".");
    });
    if (figure == figures.end()) figure = figures.insert(figures.end(), {stem, {}, {}});
    figure->pictures.push_back({stem, read_png(file)});
  }
  for (ReportFigure& figure : figures) report.figures.push_back(std::move(figure));
}

}  // namespace

Report read_report(const std::vector<std::string>& folders) {
  Report report;
  for (const std::string& folder : folders) {
    if (!fs::is_directory(folder))
      throw Error(ErrorKind::input, folder, "found no folder, expected one with results");
    const size_t before = report.sweeps.size() + report.figures.size();
    if (fs::exists(fs::path(folder) / "tradeoff.json"))
      report.sweeps.push_back(read_sweep_folder(folder));
    else
      read_figures(folder, report);
    if (before == report.sweeps.size() + report.figures.size())
      throw Error(ErrorKind::input, folder,
                  "found no results, expected tradeoff.json, or figures as .csv and .png");
  }
  return report;
}

ReportTable parse_csv(const std::string& path, const std::string& text) {
  ReportTable table;
  std::vector<std::string> row;
  std::string cell;
  bool quoted = false, any = false;
  size_t line = 1, opened = 1;
  const auto end_row = [&] {
    row.push_back(std::move(cell));
    cell.clear();
    table.rows.push_back(std::move(row));
    row.clear();
    any = false;
  };
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\n') ++line;
    if (quoted) {
      if (c != '"') {
        cell += c;
      } else if (i + 1 < text.size() && text[i + 1] == '"') {
        cell += '"';
        ++i;
      } else {
        quoted = false;
      }
      continue;
    }
    if (c == '"') {
      quoted = any = true;
      opened = line;
    } else if (c == ',') {
      row.push_back(std::move(cell));
      cell.clear();
      any = true;
    } else if (c == '\n') {
      end_row();
    } else if (c != '\r') {
      cell += c;
      any = true;
    }
  }
  if (quoted)
    throw Error(ErrorKind::input, path,
                fmt::format("line {}: found a quote that is not closed, expected CSV", opened));
  if (any) end_row();
  return table;
}

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](size_t k) -> unsigned {
      return i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0;
    };
    const unsigned group = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63];
  }
  return text;
}

}  // namespace burnish::tools
