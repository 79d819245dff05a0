"""What is proved of output_integral, whatever drives it."""

from tb.sign_off.watch import pipeline


def properties(twin):
    return [
        pipeline(
            twin,
            (
                (r"delay3_taps\[0\] <= in_last", "delay3_taps[0] <= (in_last && in_valid)"),
                (r"delay3_taps\[1\] <= 0;", ""),
                (r"out_valid <= delay2_taps\[\(5 - 1\)\]", "out_valid <= delay2_taps[3]"),
            ),
            last="in_last",
        ),
    ]
