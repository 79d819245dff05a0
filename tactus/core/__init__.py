"""What every floor of the tool uses: files, the store of answers, errors and progress."""
