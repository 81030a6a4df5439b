"""Three loops of series arithmetic with eight numbers side by side in vector registers.

A power series of many unknowns needs the sum over earlier orders, sum_j w_(top - j) x_j, of each unknown.
The compiler would vectorise the inner one of the two loops, and the sums would pass through memory once per
term.  These loops are therefore written in LLVM's language: eight columns at a time, the sums in registers
from the first term to the last.  On every processor even and odd terms are added separately, then their sums.
"""

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

LANES = 8  # numbers side by side in the widest vector registers in use
_GROUP = 4  # blocks of eight columns that share a pass over the terms

_EIGHT = ir.VectorType(ir.DoubleType(), LANES)


class _Rows:
    """Access to a C-contiguous array of doubles, eight numbers at a time."""

    def __init__(self, context, builder: ir.IRBuilder, kind: types.Array, value: ir.Value) -> None:
        array = context.make_array(kind)(context, builder, value)
        self.builder, self.data = builder, array.data
        self.length = cgutils.unpack_tuple(builder, array.shape)[-1]

    def pointer(self, row: ir.Value | None, column: ir.Value) -> ir.Value:
        """Pointer to an element; `row` None for an array of one dimension."""
        index = column if row is None else self.builder.add(self.builder.mul(row, self.length), column)
        return self.builder.gep(self.data, [index])

    def eight(self, row: ir.Value | None, column: ir.Value) -> ir.Value:
        where = self.builder.bitcast(self.pointer(row, column), _EIGHT.as_pointer())
        return self.builder.load(where, align=8)

    def put(self, row: ir.Value | None, column: ir.Value, value: ir.Value) -> None:
        where = self.builder.bitcast(self.pointer(row, column), _EIGHT.as_pointer())
        self.builder.store(value, where, align=8)


def _fused(builder: ir.IRBuilder, a: ir.Value, b: ir.Value, c: ir.Value) -> ir.Value:
    """a b + c, in one operation and with one rounding where the processor has it."""
    kind = ir.FunctionType(_EIGHT, [_EIGHT] * 3)
    function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.fmuladd.v{LANES}f64")
    return builder.call(function, [a, b, c])


def _spread(builder: ir.IRBuilder, value: ir.Value) -> ir.Value:
    """A vector of eight times `value`."""
    one = builder.insert_element(ir.Constant(_EIGHT, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(one, ir.Constant(_EIGHT, ir.Undefined), zeros)


def _total(builder: ir.IRBuilder, value: ir.Value) -> ir.Value:
    """The sum of eight numbers, by halves."""
    for half in (4, 2, 1):
        turn = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [(i + half) % LANES for i in range(LANES)])
        value = builder.fadd(value, builder.shuffle_vector(value, ir.Constant(_EIGHT, ir.Undefined), turn))
    return builder.extract_element(value, ir.Constant(ir.IntType(32), 0))


@intrinsic
def weighted_rows(_context, weights, top, step, rows, count, out):
    """out = sum over j < count of weights[top + step j] rows[j]; `out` as long as a row, a multiple of 8.

    weights and out have one dimension, rows has two; all are contiguous arrays of doubles.
    """
    signature = types.void(weights, types.intp, types.intp, rows, types.intp, out)

    def build(context, builder: ir.IRBuilder, signature, args):
        kinds = signature.args
        weight, row, result = (_Rows(context, builder, kinds[i], args[i]) for i in (0, 3, 5))
        top, step, count = args[1], args[2], args[4]
        kind, zero = top.type, ir.Constant(_EIGHT, [0.0] * LANES)
        one, lanes = ir.Constant(kind, 1), ir.Constant(kind, LANES)

        def sums(column: ir.Value, blocks: int) -> None:
            """`blocks` times eight columns from `column` on."""
            columns = [builder.add(column, ir.Constant(kind, LANES * i)) for i in range(blocks)]
            totals = [[cgutils.alloca_once(builder, _EIGHT) for _ in columns] for _parity in range(2)]
            for total in totals[0] + totals[1]:
                builder.store(zero, total)

            def add(parity: int, j: ir.Value) -> None:
                where = weight.pointer(None, builder.add(top, builder.mul(step, j)))
                factor = _spread(builder, builder.load(where))
                for total, at in zip(totals[parity], columns, strict=True):
                    builder.store(_fused(builder, factor, row.eight(j, at), builder.load(total)), total)

            with cgutils.for_range(builder, builder.ashr(count, one), intp=kind) as pair:
                j = builder.shl(pair.index, one)
                add(0, j)
                add(1, builder.add(j, one))
            with builder.if_then(builder.icmp_signed("==", builder.and_(count, one), one)):
                add(0, builder.sub(count, one))
            for even, odd, at in zip(*totals, columns, strict=True):
                result.put(None, at, builder.fadd(builder.load(even), builder.load(odd)))

        blocks = builder.sdiv(result.length, lanes)
        groups = builder.sdiv(blocks, ir.Constant(kind, _GROUP))
        with cgutils.for_range(builder, groups, intp=kind) as group:
            sums(builder.mul(group.index, ir.Constant(kind, LANES * _GROUP)), _GROUP)
        done = builder.mul(groups, ir.Constant(kind, _GROUP))
        for rest in range(1, _GROUP):
            matches = builder.icmp_signed("==", builder.sub(blocks, done), ir.Constant(kind, rest))
            with builder.if_then(matches):
                sums(builder.mul(done, lanes), rest)
        return context.get_dummy_value()

    return signature, build


@intrinsic
def next_modes(_context, numbers, earlier, r0, inverse, r_now, r_force, n, series):
    """Compute order n + 1 of all modes in a contact, and return sum_k phi_k v_k of that order.

    The last columns of `series` hold u and then v.  `earlier` holds the sums of r u and r v without their
    last terms, and `numbers` the rows c, omega^2, phi and g.  See ``contact.touch.power``.
    """
    real = types.float64
    signature = real(numbers, earlier, real, real, real, real, types.intp, series)

    def build(context, builder: ir.IRBuilder, signature, args):
        kinds = signature.args
        number, sums, row = (_Rows(context, builder, kinds[i], args[i]) for i in (0, 1, 7))
        n, kind = args[6], args[6].type
        r0, inverse, r_now, r_force = (_spread(builder, args[i]) for i in (2, 3, 4, 5))
        one, lanes = ir.Constant(kind, 1), ir.Constant(kind, LANES)
        tip = cgutils.alloca_once_value(builder, ir.Constant(_EIGHT, [0.0] * LANES))
        with cgutils.for_range(builder, builder.sdiv(number.length, lanes), intp=kind) as block:
            k = builder.mul(block.index, lanes)
            decay, square, phi, load = (number.eight(ir.Constant(kind, i), k) for i in range(4))
            at_v = builder.add(builder.sub(row.length, number.length), k)
            at_u = builder.sub(at_v, number.length)
            ru = _fused(builder, r0, row.eight(n, at_u), sums.eight(None, at_u))
            rv = _fused(builder, r0, row.eight(n, at_v), sums.eight(None, at_v))
            u = builder.fmul(inverse, rv)
            pull = _fused(builder, decay, u, builder.fmul(phi, r_force))
            drive = builder.fsub(builder.fmul(load, r_now), builder.fmul(square, ru))
            v = builder.fsub(builder.fmul(inverse, drive), pull)
            later = builder.add(n, one)
            row.put(later, at_u, u)
            row.put(later, at_v, v)
            builder.store(_fused(builder, phi, v, builder.load(tip)), tip)
        return _total(builder, builder.load(tip))

    return signature, build


@intrinsic
def next_order(_context, numbers, factor, scale, push, lift, n, series):
    """Compute order n + 2 of all modes under a force, and return the sum of phi times the coefficients.

    Row n + 2 of `series` becomes `scale` (`lift` g - c `factor` row_(n+1) - omega^2 row_n - phi `push`), with
    the rows c, omega^2, phi and g of `numbers`.  See ``contact.touch.time_series``.
    """
    real = types.float64
    signature = real(numbers, real, real, real, real, types.intp, series)

    def build(context, builder: ir.IRBuilder, signature, args):
        kinds = signature.args
        number, row = _Rows(context, builder, kinds[0], args[0]), _Rows(context, builder, kinds[6], args[6])
        n, kind = args[5], args[5].type
        factor, scale, push, lift = (_spread(builder, args[i]) for i in range(1, 5))
        after, fresh = builder.add(n, ir.Constant(kind, 1)), builder.add(n, ir.Constant(kind, 2))
        tip = cgutils.alloca_once_value(builder, ir.Constant(_EIGHT, [0.0] * LANES))
        blocks = builder.sdiv(number.length, ir.Constant(kind, LANES))
        with cgutils.for_range(builder, blocks, intp=kind) as block:
            k = builder.mul(block.index, ir.Constant(kind, LANES))
            decay, square, phi, load = (number.eight(ir.Constant(kind, i), k) for i in range(4))
            drag = builder.fmul(decay, builder.fmul(factor, row.eight(after, k)))
            pull = _fused(builder, square, row.eight(n, k), builder.fmul(phi, push))
            sum_ = builder.fsub(builder.fsub(builder.fmul(lift, load), drag), pull)
            value = builder.fmul(scale, sum_)
            row.put(fresh, k, value)
            builder.store(_fused(builder, phi, value, builder.load(tip)), tip)
        return _total(builder, builder.load(tip))

    return signature, build
