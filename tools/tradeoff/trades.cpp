#include "tradeoff/trades.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace burnish::tools {
namespace {

constexpr double kTimeTolerance = 0.05;

Trade make_trade(const Sweep& sweep, const std::string& name, const std::string& cost,
                 double SweepRow::*value, double tolerance) {
  Trade trade;
  trade.name = name;
  trade.cost = cost;
  trade.tolerance.cost = tolerance;
  std::vector<TradePoint> ours;
  for (const SweepRow& row : sweep.rows) {
    trade.points.push_back({row.*value, row.relative_l2});
    ours.push_back(trade.points.back());
    if (row.kind == RowKind::rival) ours.back().cost = 0;  // takes no part
    trade.tolerance.error = std::max(trade.tolerance.error, row.truth_noise);
  }
  trade.front = pareto_front(ours);
  return trade;
}

PlotMark mark_of(RowKind kind) {
  switch (kind) {
    case RowKind::grid:
      break;
    case RowKind::preset:
      return PlotMark::preset;
    case RowKind::paper:
      return PlotMark::paper;
    case RowKind::rival:
      return PlotMark::rival;
  }
  return PlotMark::dot;
}

std::string row_line(const Sweep& sweep, const Trade& trade, size_t i) {
  const SweepRow& row = sweep.rows[i];
  return fmt::format("  {:<34} {:>10.4g}  {:>6.2f} %{}\n", row.name, trade.points[i].cost,
                     1e2 * row.relative_l2, row.below_noise ? "  below the truth's noise" : "");
}

}  // namespace

std::vector<Trade> trades_of(const Sweep& sweep, FrameClock clock) {
  const bool wall = clock == FrameClock::wall;
  return {make_trade(sweep, "time",
                     wall ? "frame time, ms" : "frame, ms of processor time over all threads",
                     wall ? &SweepRow::frame_ms : &SweepRow::frame_cpu_ms, kTimeTolerance),
          make_trade(sweep, "bytes", "memory, bytes", &SweepRow::memory_bytes, 0),
          make_trade(sweep, "bake", "bake time, s", &SweepRow::bake_s, kTimeTolerance)};
}

Standing standing_of(const Sweep& sweep, const Trade& trade, size_t row) {
  std::vector<TradePoint> ours = trade.points;
  for (size_t i = 0; i < ours.size(); ++i)
    if (sweep.rows[i].kind == RowKind::rival && i != row) ours[i].cost = 0;
  Standing standing;
  standing.on_front = near_front(ours, row, trade.tolerance);
  const TradePoint& own = trade.points[row];
  for (const size_t i : trade.front) {
    const TradePoint& other = trade.points[i];
    if (other.error <= own.error)
      standing.cost_factor = std::max(standing.cost_factor, own.cost / other.cost);
    if (other.cost <= own.cost && other.error > 0)
      standing.error_factor = std::max(standing.error_factor, own.error / other.error);
  }
  return standing;
}

std::vector<size_t> rivals_before_front(const Sweep& sweep, const Trade& trade) {
  std::vector<size_t> before;
  for (size_t i = 0; i < sweep.rows.size(); ++i) {
    if (sweep.rows[i].kind != RowKind::rival || trade.points[i].cost <= 0) continue;
    const bool matched = std::any_of(trade.front.begin(), trade.front.end(), [&](size_t j) {
      return trade.points[j].cost <= trade.points[i].cost &&
             trade.points[j].error <= trade.points[i].error;
    });
    if (!matched) before.push_back(i);
  }
  return before;
}

std::string trades_text(const Sweep& sweep, const std::vector<Trade>& trades) {
  std::string text;
  for (const Trade& trade : trades) {
    text += fmt::format("error against {}: the front\n", trade.cost);
    for (const size_t i : trade.front) text += row_line(sweep, trade, i);
    text += fmt::format("and (on the front within {:g} % of cost and {:.2g} % of error?)\n",
                        1e2 * trade.tolerance.cost, 1e2 * trade.tolerance.error);
    for (size_t i = 0; i < sweep.rows.size(); ++i) {
      if (sweep.rows[i].kind == RowKind::grid || trade.points[i].cost <= 0) continue;
      const Standing standing = standing_of(sweep, trade, i);
      std::string line = row_line(sweep, trade, i);
      line.pop_back();
      text += line + (standing.on_front
                          ? "  on it\n"
                          : fmt::format("  no: {:.3g} times the cost or {:.3g} times the error\n",
                                        standing.cost_factor, standing.error_factor));
    }
    text += '\n';
  }
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

Plot plot_of(const Sweep& sweep, const Trade& trade) {
  Plot plot;
  plot.title = fmt::format("{} under {}: error against {}", sweep.scene, sweep.environment,
                           trade.cost.substr(0, trade.cost.find(',')));
  plot.x_label = trade.cost;
  plot.y_label = "relative L2 error of vertex radiance, %";
  plot.front = trade.front;
  plot.floor_y = 1e2 * trade.tolerance.error;
  for (size_t i = 0; i < sweep.rows.size(); ++i) {
    const SweepRow& row = sweep.rows[i];
    const double error =
        row.below_noise ? std::max(row.relative_l2, row.truth_noise) : row.relative_l2;
    plot.points.push_back({trade.points[i].cost, 1e2 * error, row.name, mark_of(row.kind)});
  }
  return plot;
}

}  // namespace burnish::tools
