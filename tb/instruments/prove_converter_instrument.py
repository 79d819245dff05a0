"""Proved properties of converter_instrument: its frames are those that its network takes."""

from tb.sign_off.properties import Property


def properties(twin):
    reader, network = twin.converter_reader, twin.readout.network
    at = "u_converter_reader_0."
    judge = f"u_readout_0.u_{network.entity}_0.u_input_controller_0."
    turn, slots = reader.slot_clocks, reader.slots
    return [
        Property(
            name="right frames",
            sentence=f"Its network never sees a wrong frame: all frames have {slots} samples, one "
            "per clock, whatever the converter sends and from every reset on.",
            states=("!broken",),
            assumes={
                f"Transfers end at least {turn} clocks apart, as is proved of converter_reader.": (
                    f"!({at}done && since != {turn})"
                ),
            },
            watch=f"""
                // Clocks since a transfer ended, at most those of a turn.
                reg [15:0] since = {turn};
                always @(posedge clk)
                    since <= rst ? {turn} : {at}done ? 1 : since == {turn} ? {turn} : since + 1;
            """,
            helps=(
                f"since >= 1 && since <= {turn}",
                f"!{at}sending || (since <= {slots} && {at}place == since - 1)",
                f"!valid || (since >= 2 && since <= {slots + 1})",
                f"last == (valid && since == {slots + 1})",
                f"since < 2 || since > {slots} || {at}sending == valid",
                f"{judge}count == (valid ? since - 2 : 0)",
                f"!{judge}dropping",
            ),
            free=(f"{at}done", f"{at}slot", f"{at}wrong"),
            reached=("last",),
            refuted_by=(
                (r"place == 3\)", "place == 2)"),
                (r"out_last <= closing", "out_last <= sending"),
                (r"\.in_last\(last\)", ".in_last(valid)"),
                (r"sending <= 0;", ""),
            ),
            clocks=slots + 6,
        ),
    ]
