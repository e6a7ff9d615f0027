#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace burnish::test {

/// The rows of a CSV of numbers, by column name. Throws when the file is missing or empty, so that
/// a test without its data fails.
inline std::vector<std::map<std::string, double>> read_csv(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path + ": missing");
  std::string line, cell;
  std::getline(in, line);
  std::vector<std::string> names;
  for (std::stringstream header(line); std::getline(header, cell, ',');) names.push_back(cell);
  std::vector<std::map<std::string, double>> rows;
  while (std::getline(in, line)) {
    std::map<std::string, double> row;
    size_t column = 0;
    for (std::stringstream values(line); std::getline(values, cell, ',');)
      row[names.at(column++)] = std::strtod(cell.c_str(), nullptr);
    rows.push_back(std::move(row));
  }
  if (rows.empty()) throw std::runtime_error(path + ": no rows");
  return rows;
}

inline std::vector<std::map<std::string, double>> read_golden(const std::string& name) {
  return read_csv(std::string(BURNISH_TEST_DATA) + "/golden/" + name);
}

}  // namespace burnish::test
