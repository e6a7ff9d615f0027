#pragma once

#include "burnish/sphere/direction.h"

namespace burnish::test {

/// A direction as T stores it, for a truth that is computed in double from the same numbers. In a
/// function of its own, since g++ 12 at -O2 turns a double that is rounded to float and back into
/// the unrounded double, two at a time (its vectorizer of straight-line code).
template <class T>
[[gnu::noinline]] Vector3<T> stored(const Vector3d& v) {
  return v.cast<T>();
}

}  // namespace burnish::test
