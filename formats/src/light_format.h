#pragma once

/// What the reader and the writer of light files share.
namespace burnish {

inline constexpr const char* kLightFormatName = "burnish lights";

}  // namespace burnish
