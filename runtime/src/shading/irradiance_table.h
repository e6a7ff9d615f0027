#pragma once

#include "burnish/shading/prepared_lights.h"

namespace burnish {

/// Starts the tables of the lobes' ladder shares: one for each ladder of the transfer, none without
/// such a lobe. Leaves what finishing shares in lights.scratch.
void begin_irradiance_tables(const PreparedTransfer& transfer, PreparedLights& lights);

/// May run for several ladders at once.
void finish_irradiance_table(const PreparedTransfer& transfer, size_t ladder,
                             PreparedLights& lights);

}  // namespace burnish
