#include "tradeoff/report_page.h"

#include <algorithm>

#include <fmt/format.h>

#include "tradeoff/plot.h"

namespace burnish::tools {
namespace {

constexpr size_t kMostTableRows = 60;

constexpr const char* kHead = R"(<!DOCTYPE html>
<html xmlns="http://www.w3.org/1999/xhtml" lang="en">
<head>
<meta charset="utf-8"/>
<meta name="viewport" content="width=device-width"/>
<meta name="color-scheme" content="light dark"/>
<title>Burnish: what was measured</title>
<style>
:root{--paper:#fff;--ink:#222;--soft:#666;--line:#ddd;--mark:#0b62c4}
@media (prefers-color-scheme:dark){:root{--paper:#16181c;--ink:#e8e8e8;--soft:#a0a4ab;--line:#33373e;--mark:#6fb1ff}}
body{font:15px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--paper);max-width:1020px;margin:2em auto;padding:0 1em}
h1,h2,h3{line-height:1.2}h2{border-top:1px solid var(--line);padding-top:1em;margin-top:2em}
.scroll{overflow-x:auto}table{border-collapse:collapse;font-size:13px;font-variant-numeric:tabular-nums}
th,td{padding:.2em .7em;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}
th:first-child,td:first-child,.headline td:nth-child(2),.headline th:nth-child(2){text-align:left}th{color:var(--soft);font-weight:600}
.on{color:var(--mark);font-weight:600}
figure{margin:1em 0}figcaption,.soft{color:var(--soft);font-size:13px}
img,svg{max-width:100%;height:auto}pre{white-space:pre-wrap;font-size:13px;border-left:3px solid var(--line);padding-left:1em}
code{font-size:13px;word-break:break-all}
</style>
</head>
<body>
<h1>Burnish: what was measured</h1>
)";

std::string table_html(const ReportTable& table, size_t most_rows = kMostTableRows) {
  if (table.rows.empty()) return "";
  std::string html = "<div class=\"scroll\"><table>\n";
  const size_t shown = std::min(table.rows.size(), most_rows + 1);
  for (size_t i = 0; i < shown; ++i) {
    const char* tag = i == 0 ? "th" : "td";
    html += "<tr>";
    for (const std::string& cell : table.rows[i])
      html += fmt::format("<{0}>{1}</{0}>", tag, xml_escaped(cell));
    html += "</tr>\n";
  }
  html += "</table></div>\n";
  if (shown < table.rows.size())
    html += fmt::format("<p class=\"soft\">and {} more rows in the CSV file</p>\n",
                        table.rows.size() - shown);
  return html;
}

std::string picture_html(const ReportPicture& picture) {
  return fmt::format(
      "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"/><figcaption>{0}</figcaption>"
      "</figure>\n",
      xml_escaped(picture.caption), base64(picture.png));
}

std::string machine_html(const nlohmann::ordered_json& machine) {
  std::string text;
  for (const auto& [name, value] : machine.items())
    text += (text.empty() ? "" : "; ") + name + " " +
            (value.is_string()
                 ? value.get<std::string>()
                 : value.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace));
  return fmt::format("<p class=\"soft\"><code>{}</code></p>\n", xml_escaped(text));
}

std::string error_text(const SweepRow& row) {
  return row.below_noise ? fmt::format("below noise ({:.2f} %)", 1e2 * row.truth_noise)
                         : fmt::format("{:.2f} %", 1e2 * row.relative_l2);
}

/// A figure, or nothing where it was not measured.
std::string figure_text(double value, double scale, int digits) {
  return value > 0 ? fmt::format("{:.{}f}", value * scale, digits) : std::string();
}

double frame_of(const SweepRow& row, FrameClock clock) {
  return clock == FrameClock::wall ? row.frame_ms : row.frame_cpu_ms;
}

/// Presets, the papers' choices and rivals, scene by scene.
std::string headline_html(const Report& report) {
  ReportTable table;
  table.rows.push_back({"scene", "what", "relative L2", "95 %", "99.9 %",
                        report.clock == FrameClock::wall ? "frame, ms" : "frame, CPU ms",
                        "memory, MB", "file, MB", "bake, s", "on the front of"});
  for (const ReportSweep& entry : report.sweeps) {
    const Sweep& sweep = entry.sweep;
    const std::vector<Trade> trades = trades_of(sweep, report.clock);
    for (size_t i = 0; i < sweep.rows.size(); ++i) {
      const SweepRow& row = sweep.rows[i];
      if (row.kind == RowKind::grid) continue;
      std::vector<std::string> cells = {sweep.scene,
                                        row.name,
                                        error_text(row),
                                        figure_text(row.absolute_95, 1, 3),
                                        figure_text(row.absolute_999, 1, 3),
                                        figure_text(frame_of(row, report.clock), 1, 2),
                                        figure_text(row.memory_bytes, 1e-6, 2),
                                        figure_text(row.file_bytes, 1e-6, 2),
                                        figure_text(row.bake_s, 1, 1)};
      std::string fronts;
      for (const Trade& trade : trades)
        if (trade.points[i].cost > 0 && standing_of(sweep, trade, i).on_front)
          fronts += (fronts.empty() ? "" : ", ") + trade.name;
      cells.push_back(fronts);
      table.rows.push_back(std::move(cells));
    }
  }
  return table_html(table, table.rows.size());
}

std::string front_html(const Sweep& sweep, const Trade& trade) {
  ReportTable table;
  table.rows.push_back({"the front", trade.cost, "relative L2"});
  for (const size_t i : trade.front)
    table.rows.push_back({sweep.rows[i].name, fmt::format("{:.4g}", trade.points[i].cost),
                          error_text(sweep.rows[i])});
  std::string html = table_html(table), before;
  for (const size_t i : rivals_before_front(sweep, trade))
    before += (before.empty() ? "" : ", ") + sweep.rows[i].name;
  if (!before.empty())
    html += fmt::format("<p>Rivals that nothing of ours is as good as in both: {}.</p>\n",
                        xml_escaped(before));
  return html;
}

std::string sweep_html(const ReportSweep& entry, FrameClock clock) {
  const Sweep& sweep = entry.sweep;
  std::string html = fmt::format(
      "<h2>{} under {}</h2>\n<p>{} vertices, {} settings and rivals. Errors are relative L2 of "
      "vertex radiance against the truth under the whole map, without the truth's noise.</p>\n",
      xml_escaped(sweep.scene), xml_escaped(sweep.environment), sweep.vertices, sweep.rows.size());
  html += machine_html(sweep.machine);
  for (const Trade& trade : trades_of(sweep, clock))
    html += "<figure>" + plot_svg(plot_of(sweep, trade)) + "</figure>\n" + front_html(sweep, trade);
  if (!entry.pictures.empty())
    html += "<h3>Pictures</h3>\n<p>Shaded, the truth, and FLIP: white is what an eye sees.</p>\n";
  for (const ReportPicture& picture : entry.pictures) html += picture_html(picture);
  return html;
}

}  // namespace

std::string report_page(const Report& report) {
  std::string html = kHead;
  html += "<p class=\"soft\">This page was made by:</p>\n" + machine_html(report.machine);
  if (!report.sweeps.empty())
    html += "<h2>Headline</h2>\n<div class=\"headline\">" + headline_html(report) + "</div>\n";
  for (const ReportSweep& sweep : report.sweeps) html += sweep_html(sweep, report.clock);
  if (!report.figures.empty() || !report.notes.empty()) html += "<h2>Reproduction</h2>\n";
  if (!report.notes.empty()) html += "<pre>" + xml_escaped(report.notes) + "</pre>\n";
  for (const ReportFigure& figure : report.figures) {
    html += fmt::format("<h3>{}</h3>\n", xml_escaped(figure.name));
    for (const ReportPicture& picture : figure.pictures) html += picture_html(picture);
    html += table_html(figure.table);
  }
  return html + "</body>\n</html>\n";
}

}  // namespace burnish::tools
