// Numbers as Python computes them: IEEE 754 doubles, and integers that do not overflow.
//
// Compile without contraction of a * b + c to one operation: Python rounds twice.
#include <cmath>

#include "frame.hpp"

namespace roverlink {

namespace {

constexpr double kTooLargeForFloat = 0x1.ffffffp127;  // halfway between the largest float and 2**128
constexpr double kExactSteps = 0x1p96;                // an integer below it leaves room for one more step

__extension__ using Wide = __int128;

// Converts a double without a fraction to an integer.
bool to_whole(double value, Wide *result) {
  if (!(std::fabs(value) < kExactSteps)) return false;  // also NaN
  *result = static_cast<Wide>(value);
  return true;
}

// Reads the number with which an expression begins.
Number load(const rl_expression &expression, const Slot *frame) {
  const Slot &slot = frame[expression.slot];
  Number number{};
  switch (expression.source) {
    case RL_SIGNED:
      number.whole = true;
      number.integer = static_cast<int64_t>(slot.bits);
      break;
    case RL_UNSIGNED:
      number.whole = true;
      number.integer = slot.bits;
      break;
    case RL_SINGLE:
      number.real = static_cast<double>(bits_of<float>(static_cast<uint32_t>(slot.bits)));
      break;
    case RL_NANOSECONDS:
      number.whole = true;
      number.integer = static_cast<Wide>(static_cast<int64_t>(slot.bits)) * 1000000000 +
                       static_cast<Wide>((&slot)[1].bits);
      break;
    default:
      number.real = bits_of<double>(slot.bits);
  }
  return number;
}

double real_of(const Number &number) { return number.whole ? static_cast<double>(number.integer) : number.real; }

// Applies a step to an integer: Python rounds the quotient of // down.
bool apply_whole(const rl_step &step, Wide *value) {
  const Wide operand = step.whole;
  switch (step.code) {
    case RL_TIMES: return !__builtin_mul_overflow(*value, operand, value);
    case RL_PLUS: return !__builtin_add_overflow(*value, operand, value);
    case RL_MINUS: return !__builtin_sub_overflow(*value, operand, value);
    case RL_FLOORED:
      if (operand <= 0) return false;
      *value = *value / operand - (*value % operand < 0 ? 1 : 0);
      return true;
    default: return false;
  }
}

// Applies a step. An integer becomes the nearest double at the first step whose operand is none.
bool apply(const rl_step &step, Number *number) {
  if (number->whole) {
    if (step.code == RL_NEGATE) {
      number->integer = -number->integer;
      return true;
    }
    if (step.is_whole != 0) return apply_whole(step, &number->integer);
    number->real = static_cast<double>(number->integer);
    number->whole = false;
  }
  const double operand = step.is_whole != 0 ? static_cast<double>(step.whole) : step.real;
  switch (step.code) {
    case RL_NEGATE: number->real = -number->real; return true;
    case RL_TIMES: number->real *= operand; return true;
    case RL_BY: number->real /= operand; return true;
    case RL_PLUS: number->real += operand; return true;
    case RL_MINUS: number->real -= operand; return true;
    default: return false;
  }
}

// A constant of the table.
Number constant(const uint64_t *words) {
  Number number{};
  number.whole = words[0] != 0;
  if (number.whole) number.integer = static_cast<int64_t>(words[1]);
  else number.real = bits_of<double>(words[1]);
  return number;
}

}  // namespace

bool compute(const rl_table &table, const rl_expression &expression, const Slot *frame, Number *result) {
  const bool has_default = expression.otherwise != RL_NONE;
  if (expression.slot == RL_NONE || (expression.presence != RL_NONE && !frame[expression.presence].set)) {
    if (!has_default) return false;
    *result = constant(table.words + expression.otherwise);
    return true;
  }
  Number number = load(expression, frame);
  if (expression.cases != RL_NONE) {
    const uint64_t *cases = table.words + expression.cases;
    for (uint64_t index = 0; index < cases[0]; ++index)
      if (number.integer == static_cast<Wide>(static_cast<int64_t>(cases[1 + 3 * index]))) {
        *result = constant(cases + 2 + 3 * index);
        return true;
      }
    if (!has_default) return false;
    *result = constant(table.words + expression.otherwise);
    return true;
  }
  for (uint32_t index = 0; index < expression.steps; ++index)
    if (!apply(table.steps[expression.first_step + index], &number)) return false;
  if ((expression.flags & RL_ROUND) != 0 && !number.whole) {
    if (!to_whole(std::nearbyint(number.real), &number.integer)) return false;
    number.whole = true;
  }
  if ((expression.flags & RL_CHECK_SINGLE) != 0) {
    const double value = real_of(number);
    if (std::fabs(value) >= kTooLargeForFloat && !std::isinf(value)) return false;
  }
  *result = number;
  return true;
}

bool fit(const Number &number, uint8_t primitive, uint64_t *bits) {
  if (primitive == RL_FLOAT64) {
    *bits = bits_of<uint64_t>(real_of(number));
    return true;
  }
  if (primitive == RL_FLOAT32) {
    const double value = real_of(number);
    if (std::fabs(value) >= kTooLargeForFloat && !std::isinf(value)) return false;
    *bits = bits_of<uint32_t>(static_cast<float>(value));
    return true;
  }
  if (!number.whole) return false;
  const bool is_signed =
      primitive == RL_INT8 || primitive == RL_INT16 || primitive == RL_INT32 || primitive == RL_INT64;
  const uint32_t width = primitive == RL_BOOL ? 1 : 8 * size_of(primitive);
  const Wide one = 1;
  const Wide least = is_signed ? -(one << (width - 1)) : 0;
  const Wide most = is_signed ? (one << (width - 1)) - 1 : (one << width) - 1;
  if (number.integer < least || number.integer > most) return false;
  *bits = static_cast<uint64_t>(number.integer);
  return true;
}

// Rotations about the fixed axes x, y and z in this order (REP 103), in the order of operations of
// roverlink.runtime.convert.rotations.
void quaternion(const double angles[3], double xyzw[4]) {
  const double sin_roll = std::sin(angles[0] * 0.5), cos_roll = std::cos(angles[0] * 0.5);
  const double sin_pitch = std::sin(angles[1] * 0.5), cos_pitch = std::cos(angles[1] * 0.5);
  const double sin_yaw = std::sin(angles[2] * 0.5), cos_yaw = std::cos(angles[2] * 0.5);
  const double both_cos = cos_roll * cos_pitch, both_sin = sin_roll * sin_pitch;
  const double rolled = sin_roll * cos_pitch, pitched = cos_roll * sin_pitch;
  xyzw[0] = rolled * cos_yaw - pitched * sin_yaw;
  xyzw[1] = pitched * cos_yaw + rolled * sin_yaw;
  xyzw[2] = both_cos * sin_yaw - both_sin * cos_yaw;
  xyzw[3] = both_cos * cos_yaw + both_sin * sin_yaw;
}

void angles(const double xyzw[4], double result[3]) {
  constexpr double straight = 1 - 1e-15;  // from here roll and yaw cannot be told apart
  const double x = xyzw[0], y = xyzw[1], z = xyzw[2], w = xyzw[3];
  const double square = x * x + y * y + z * z + w * w;
  result[0] = result[1] = result[2] = 0.0;
  if (square == 0) return;
  const double sine = 2 * (w * y - z * x) / square;
  if (std::fabs(sine) >= straight) {
    result[1] = std::copysign(M_PI / 2, sine);
    result[2] = 2 * std::atan2(z, w);
    return;
  }
  result[0] = std::atan2(2 * (w * x + y * z), w * w - x * x - y * y + z * z);
  result[1] = std::asin(sine);
  result[2] = std::atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z);
}

bool is_utf8(const uint8_t *text, size_t size) {
  // The well-formed sequences of Unicode 15, table 3-7.
  for (size_t at = 0; at < size;) {
    const uint8_t first = text[at++];
    if (first < 0x80) continue;
    uint32_t more = 0;
    uint8_t low = 0x80, high = 0xbf;
    if (first >= 0xc2 && first <= 0xdf) more = 1;
    else if (first >= 0xe0 && first <= 0xef) {
      more = 2;
      if (first == 0xe0) low = 0xa0;
      if (first == 0xed) high = 0x9f;
    } else if (first >= 0xf0 && first <= 0xf4) {
      more = 3;
      if (first == 0xf0) low = 0x90;
      if (first == 0xf4) high = 0x8f;
    } else return false;
    if (more > size - at) return false;
    for (; more != 0; --more, ++at) {
      if (text[at] < low || text[at] > high) return false;
      low = 0x80;
      high = 0xbf;
    }
  }
  return true;
}

}  // namespace roverlink
