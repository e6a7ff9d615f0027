#pragma once

#include <span>
#include <string>

#include "bench/reproduce/figure.h"

/// The page of reproduced figures, and the files of each.
namespace burnish::tools {

/// A figure and what came of it.
struct MadeFigure {
  const Figure* figure = nullptr;  ///< never null
  FigureResult result;
  double seconds = 0;  ///< that it took
};

/// Writes the rows as NAME.csv and each picture as its PNG into `folder`, which exists. Throws
/// Error(ErrorKind::output).
void write_figure_files(const MadeFigure& made, const std::string& folder);

/// Rows as Markdown tables, one for each value of the column "what", below what is the same in all
/// rows of it. Numbers have four digits.
std::string markdown_tables(const std::vector<BenchRow>& rows);

/// The page: of each figure what the paper shows, its pictures, numbers, what we got and the
/// command. `pictures` is the folder of the pictures as seen from the page.
std::string reproduction_page(std::span<const MadeFigure> figures, const std::string& pictures,
                              const nlohmann::ordered_json& machine);

}  // namespace burnish::tools
