within Interfaces;
connector IntegerOutput = output Integer "Integer signal, output";
