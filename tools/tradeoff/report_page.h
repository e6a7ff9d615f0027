#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tradeoff/trades.h"

/// What was measured as one HTML page that needs nothing else: no server, no script, no other file.
namespace burnish::tools {

/// A picture as a file's bytes.
struct ReportPicture {
  std::string caption;
  std::string png;
};

/// A table with its header first.
struct ReportTable {
  std::vector<std::vector<std::string>> rows;
};

/// A figure of a paper, made again: a table, pictures, or both.
struct ReportFigure {
  std::string name;
  ReportTable table;
  std::vector<ReportPicture> pictures;
};

/// A sweep with the pictures that it names.
struct ReportSweep {
  Sweep sweep;
  std::vector<ReportPicture> pictures;
};

struct Report {
  std::vector<ReportSweep> sweeps;
  std::vector<ReportFigure> figures;
  std::string notes;               ///< Markdown of the reproduction, shown as it is; may be empty
  nlohmann::ordered_json machine;  ///< machine_record of who made the page
  FrameClock clock = FrameClock::wall;
};

/// What folders hold: a sweep (tradeoff.json with its pictures), and figures (NAME.csv and
/// NAME*.png, and *.md with text about them). Throws Error for a folder without either and for what
/// cannot be read.
Report read_report(const std::vector<std::string>& folders);

/// The page: well-formed as XML, light or dark as the reader's system prefers.
std::string report_page(const Report& report);

/// RFC 4180. Throws Error that names `path` and the line of a quote that is not closed.
ReportTable parse_csv(const std::string& path, const std::string& text);

/// RFC 4648, with padding.
std::string base64(const std::string& bytes);

}  // namespace burnish::tools
