"""Values that break readers: spellings of them for YAML and JSON, and byte strings for any file."""

DEEP = 400

NUMBERS = (
    "0", "-0.0", "-1", "1", "2", "0.5", "1e-300", "1e9", "-1e9", "1e300", "-1e300", "1e308", "1e999",
    "-1e999",
    "100000000", "4294967296", "9223372036854775808", "9" * 400, "-" + "9" * 5000, "NaN", ".nan", "Infinity",
    "-Infinity", ".inf", "-.inf", "0x10", "0o7", "1_000", "1e", "١٢", "²",
)  # fmt: skip

TEXTS = (
    "''", '"\\u0000"', '"a\\u0000b"', '"\\ud800"', '"\\udcff"', '"²"', '"../x"', '"/"', '"."', '"/nowhere"',
    '"a\\nb"', '"\\u202e"', '"\\u001b[31m"', '"' + "x" * 5000 + '"', '","', '"a:b"', '"-1"', '"--help"',
    '"%s %n {0}"', '"<!--<script>"', '"e\\u0301"', "text", "2026-11-29", "12:30", "passive", "half", "camera",
)  # fmt: skip

OTHERS = (
    "null", "~", "true", "false", "[]", "{}", "[null]", "[[]]", "{a: 1}", '{"": 0}', "[1, 2]", "[1, 2, 3]",
    "[" * DEEP + "]" * DEEP, "{a: " * DEEP + "1" + "}" * DEEP, '{"a":' * DEEP + "1" + "}" * DEEP,
    "[" + "0," * 3000 + "0]", "!!int ''", "!!bool maybe", "!!timestamp x", "!!float x", "!!binary '%'",
    "!!python/object/apply:os.getcwd []", "!!set {a}", "!!omap [a: 1]", "!!str [1]", "!unknown 1", "&a [*a]",
    "*a", "*nothing", "<<", "{<<: {a: 1}}", "{<<: 1}", "{1: 2}", "{null: 2}", "{[1]: 2}", "{a: 1, a: 2}", "|",
    "- - -", "%YAML 1.1", "--- a\n--- b", "'", '"', "[", "{", "@", "`",
)  # fmt: skip

BYTES = (
    b"", b"\0", b"\0" * 64, b"\xff", b"\xfe\xff", b"\xff\xfe", b"\xef\xbb\xbf", b"\xed\xa0\x80", b"\xc2\xb2",
    b"\x85", b"\r", b"\n", b"\n\n", b"\t", b"\x1b[2J", b"%", b"#", b",", b":", b"- ", b"nan", b"inf",
    b"1e999", b"-1", b"9" * 400, b"\x7f\xff\xff\xff", b"\xff\xff\xff\xff", b"\x80\0\0\0",
    b"A" * 2000, b"\n" * 2000,
)  # fmt: skip


def bomb() -> bytes:
    """A few lines of YAML whose aliases stand for 10^9 values."""
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    for level in range(1, 9):
        lines.append(f"a{level}: &a{level} [{', '.join([f'*a{level - 1}'] * 10)}]")
    return "\n".join(lines).encode() + b"\n"
