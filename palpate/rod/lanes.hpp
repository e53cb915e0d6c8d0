// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Vectors whose components are SIMD lanes, or plain numbers. Every function that a kernel uses is inlined into it: one
/// that was not might be linked in its wide form into a program on a narrow processor
/// (tests/rod/kernel_symbols.cmake).
namespace palpate::rod_lanes {

template <class T>
struct Vec {
  T x, y, z;
};

template <class T>
[[gnu::always_inline]] inline Vec<T> operator+(const Vec<T>& a, const Vec<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
[[gnu::always_inline]] inline Vec<T> operator-(const Vec<T>& a, const Vec<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
[[gnu::always_inline]] inline Vec<T> operator*(const T& s, const Vec<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
[[gnu::always_inline]] inline Vec<T> operator*(const Vec<T>& a, const Vec<T>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <class T>
[[gnu::always_inline]] inline T dot(const Vec<T>& a, const Vec<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
[[gnu::always_inline]] inline Vec<T> cross(const Vec<T>& a, const Vec<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Sums that run from left to right, so that each product is fused with the sum so far.
/// x + s b, x - s b, x + a b by component, x + a x b
template <class T>
[[gnu::always_inline]] inline Vec<T> plus(const Vec<T>& x, const T& s, const Vec<T>& b) {
  return {x.x + s * b.x, x.y + s * b.y, x.z + s * b.z};
}
template <class T>
[[gnu::always_inline]] inline Vec<T> minus(const Vec<T>& x, const T& s, const Vec<T>& b) {
  return {x.x - s * b.x, x.y - s * b.y, x.z - s * b.z};
}
template <class T>
[[gnu::always_inline]] inline Vec<T> plus(const Vec<T>& x, const Vec<T>& a, const Vec<T>& b) {
  return {x.x + a.x * b.x, x.y + a.y * b.y, x.z + a.z * b.z};
}
template <class T>
[[gnu::always_inline]] inline Vec<T> minus(const Vec<T>& x, const Vec<T>& a, const Vec<T>& b) {
  return {x.x - a.x * b.x, x.y - a.y * b.y, x.z - a.z * b.z};
}
template <class T>
[[gnu::always_inline]] inline Vec<T> plus_cross(const Vec<T>& x, const Vec<T>& a, const Vec<T>& b) {
  return {x.x + a.y * b.z - a.z * b.y, x.y + a.z * b.x - a.x * b.z, x.z + a.x * b.y - a.y * b.x};
}
template <class T>
[[gnu::always_inline]] inline Vec<T> three(const T* y, int first) {
  return {y[first], y[first + 1], y[first + 2]};
}
template <class T>
[[gnu::always_inline]] inline void put(const Vec<T>& v, T* y, int first) {
  y[first] = v.x, y[first + 1] = v.y, y[first + 2] = v.z;
}

}  // namespace palpate::rod_lanes
