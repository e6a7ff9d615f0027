#pragma once

#include "burnish/shading/prepared_lights.h"

namespace burnish {

/// Makes the tables of the lobes' ladder shares: one for each ladder of the transfer, none without
/// such a lobe. Uses lights.scratch.
void make_irradiance_tables(const PreparedTransfer& transfer, PreparedLights& lights);

}  // namespace burnish
