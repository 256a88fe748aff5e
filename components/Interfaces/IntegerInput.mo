within Interfaces;
connector IntegerInput = input Integer "Integer signal, input";
