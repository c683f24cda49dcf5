"""Names in pictures are text, whatever signs are in them."""

from rockshed.pictures.style import captioned, legend, plain_powers


def test_names_with_dollars_brackets_and_braces_are_drawn_letter_for_letter(tmp_path):
    name = r"a.$x_{$ 100 % [front] \alpha"
    file = tmp_path / "picture.png"
    with captioned([name], file, 3.0, 2.0) as made:
        axes = made.subplots()
        axes.plot([1.0, 10.0], [1.0, 100.0], label=name)
        axes.set(xlabel=name, ylabel=name, title=name, yscale="log")
        plain_powers(axes.yaxis)
        legend(axes)
        made.fit()
        drawn = [axes.xaxis.label, axes.yaxis.label, *axes.get_legend().get_texts()]
        assert not any(text.get_parse_math() for text in drawn)
    assert file.is_file()
    assert "10" in [label.get_text() for label in axes.get_yticklabels()]
