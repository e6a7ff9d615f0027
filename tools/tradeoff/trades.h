#pragma once

#include <string>
#include <vector>

#include "tradeoff/pareto.h"
#include "tradeoff/plot.h"
#include "tradeoff/sweep.h"

/// What a sweep says: error against each cost, which settings are best, and where the presets are.
namespace burnish::tools {

/// Which clock a frame is told by. Processor time is the one to read on a machine that does other
/// things, too.
enum class FrameClock { wall, cpu };

/// Error against one cost, over all rows of a sweep.
struct Trade {
  std::string name;                ///< of its files: "time", "bytes", "bake"
  std::string cost;                ///< what and unit, for an axis
  std::vector<TradePoint> points;  ///< [rows]
  std::vector<size_t> front;       ///< rows of our own, by rising cost
  TradeTolerance tolerance;        ///< bytes are exact
};

/// Against frame time, against memory and against bake time.
std::vector<Trade> trades_of(const Sweep& sweep, FrameClock clock);

/// Where a row is in a trade.
struct Standing {
  bool on_front = false;    ///< within the tolerance
  double cost_factor = 1;   ///< its cost over that of the cheapest of ours that errs no more
  double error_factor = 1;  ///< its error over that of the best of ours that costs no more
};
Standing standing_of(const Sweep& sweep, const Trade& trade, size_t row);

/// Rivals that none of ours is as good as in both.
std::vector<size_t> rivals_before_front(const Sweep& sweep, const Trade& trade);

/// The fronts and where presets, the papers' choices and rivals stand, as lines for people.
std::string trades_text(const Sweep& sweep, const std::vector<Trade>& trades);

/// The trade as a plot. Where the truth cannot tell an error it is drawn at the truth's noise.
Plot plot_of(const Sweep& sweep, const Trade& trade);

}  // namespace burnish::tools
