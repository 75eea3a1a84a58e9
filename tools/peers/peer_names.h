// The rows of the comparison, by which the ratios find them.
#pragma once

namespace sopt {

inline constexpr const char* kSoptFirstPath = "sopt first path";
inline constexpr const char* kSoptFirstPathOneStream = "sopt first path, 1 stream";
inline constexpr const char* kSoptRrtStar = "sopt first path, rrt_star";
inline constexpr const char* kSoptRrtStarOneStream = "sopt first path, rrt_star, 1 s.";
inline constexpr const char* kSoptPlan = "sopt verified plan";
inline constexpr const char* kOmplRrtStar = "RRT*";
inline constexpr const char* kOmplRrtStarExact = "RRT*, exact test";
inline constexpr const char* kOmplInformedRrtStar = "Informed RRT*";
inline constexpr const char* kOmplBitStar = "BIT*";
inline constexpr const char* kOmplRrtConnect = "RRT-Connect";
inline constexpr const char* kOmplRrtConnectExact = "RRT-Connect, exact test";
inline constexpr const char* kOmplSimplified = "RRT-Connect + simplify";
inline constexpr const char* kOmplSimplifiedExact = "RRT-Connect + simplify, exact";
inline constexpr const char* kOmplRrtStarLong = "RRT*, whole budget";

}  // namespace sopt
